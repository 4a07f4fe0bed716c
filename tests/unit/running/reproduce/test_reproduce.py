"""`clearance reproduce`: complete, judged and rendered rows; missing values are reported."""

from __future__ import annotations

import io
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from campaigns import library, load_file
from clearance.cli import VIOLATED, WRONG_INPUT, invoke
from worker.running.opening.opened import closed_loop
from worker.running.reproduce import compare, figures, ours, render, steps
from worker.running.reproduce.compare import RESULTS, Reproduction, chosen, reproduce, tables
from worker.running.reproduce.published import PLACE, Fly, Model, Result, Search, at, direct
from worker.running.reproduce.robots import NO_MINIMUM, UNICYCLE

KEYS = {"table", "row", "published", "ours", "tolerance", "agrees"}

# How many numbers each table prints, places apart: results of a search, parameters of the worst cases.
PRINTED = {
    "4.1": 2, "4.2": 2, "4.3": 2, "4.4": 2, "5.1": 2, "5.2": 2, "5.3": 1, "5.4": 4, "5.5": 24, "5.6": 2, "5.7": 2,
    "5.8": 1, "5.9": 4, "5.10": 9, "7.1": 2, "7.2": 4, "7.3": 18,
    "figure 6.1": 1, "figure 6.2": 1, "figure 6.3": 1, "figure 6.4": 1, "figure 7.15": 1,
}  # fmt: skip


@pytest.fixture(scope="module")
def made() -> Reproduction:
    missing = Result("5.1", "augury", UNICYCLE, Search("Augury", ("augury",), 100), 0.9, model=Model(0.94, 0.1))
    return reproduce(["section 3.2.4", "figure 3.8", "4.1", "5.1", "5.3"], published=(*RESULTS, missing))


@pytest.mark.parametrize("table", PRINTED)
def test_every_printed_number_has_its_row(table: str) -> None:
    rows = [r for r in RESULTS if r.table == table and r.published is not None]
    own = [r for r in rows if not r.row.startswith(("value at", "H-DIRECT"))]  # values of the text, and repeated points
    assert len(own) == PRINTED[table]


def test_rows_are_distinct() -> None:
    names = [(r.table, r.row) for r in RESULTS]
    assert len(set(names)) == len(names)


def test_tables_are_in_their_order() -> None:
    found = tables()
    assert found.index("5.2") < found.index("5.10") < found.index("figure 6.1") < found.index("7.1")
    assert found[-1] == "reconstruction"


def test_a_name_means_a_table_or_a_chapter() -> None:
    assert chosen(["5.1"]) == ["5.1"]
    assert chosen(["3.8"]) == ["figure 3.8"]
    assert chosen(["4"]) == ["4.1", "4.2", "4.3", "4.4"]
    assert chosen([]) == tables()
    with pytest.raises(ValueError, match=r"unknown table .9\.9.; choose from .*5\.10"):
        chosen(["9.9"])


def _row(made: Reproduction, table: str, name: str) -> compare.Row:
    return next(r for r in made.rows if (r.table, r.row) == (table, name))


class TestRows:
    def test_json_has_its_keys_and_is_strict(self, made: Reproduction) -> None:
        document = json.loads(json.dumps(render.document(made), allow_nan=False))
        assert {"rows", "seconds", "compile_seconds"} <= set(document)
        assert document["seconds"] > 0
        assert all(set(row) >= KEYS for row in document["rows"])
        assert document["counts"]["rows"] == len(document["rows"]) == 1 + 1 + 4 + (2 + 1) + 3

    def test_nominal_is_checked_against_the_model_and_shown_next_to_the_published_value(
        self, made: Reproduction
    ) -> None:
        row = _row(made, "section 3.2.4", "nominal")
        assert (row.published, row.model, row.tolerance, row.agrees) == (0.9436, 0.9435642, 2e-6, True)
        assert row.difference == pytest.approx(row.ours - 0.9436)

    def test_a_published_local_minimum_that_does_not_exist_is_a_disagreement_with_a_reason(
        self, made: Reproduction
    ) -> None:
        row = _row(made, "4.1", "fmincon, case 1")
        assert row.agrees is False
        assert not row.broken
        assert NO_MINIMUM in row.note
        assert row.ours_at == {"vehicle.m": 6.0, "vehicle.J": 0.06}
        assert row.published_at == {"vehicle.m": 4.4224, "vehicle.J": 0.06}

    def test_the_search_that_the_reference_demands_agrees(self, made: Reproduction) -> None:
        row = _row(made, "5.3", "DIRECT, 100 iterations")
        assert row.agrees
        assert row.must
        assert row.place == PLACE
        assert row.ours_spent.evaluations is not None

    def test_a_curve_has_a_direction(self, made: Reproduction) -> None:
        row = _row(made, "figure 3.8", "d_min over J")
        assert (row.published, row.ours, row.agrees) == ("falls", "falls", True)


class TestMissing:
    def test_a_method_that_is_not_there(self) -> None:
        asked = Search("Augury", ("augury",), 100)
        [row] = reproduce(published=[Result("5.1", "augury", UNICYCLE, asked, 0.9, model=Model(0.94, 0.1))]).rows
        assert (row.ours, row.agrees, row.available, row.broken) == (None, None, False, True)
        assert " method Augury" in row.note
        assert row.unit == "m"

    def test_a_campaign_that_is_not_there(self) -> None:
        [row] = reproduce(published=[Result("5.1", "nominal", UNICYCLE, Fly(), 0.9, variant="no_such")]).rows
        assert (row.ours, row.agrees, row.available) == (None, None, False)
        assert "no campaign no_such" in row.note

    def test_a_parameter_that_is_not_there(self) -> None:
        asked = Fly((("vehicle.bogus", 1.0),))
        [row] = reproduce(published=[Result("5.1", "nominal", UNICYCLE, asked, 0.9)]).rows
        assert not row.available
        assert "vehicle.bogus" in row.note

    def test_a_parameter_of_its_search_that_is_not_there(self) -> None:
        case = replace(UNICYCLE, paths=(("m", "vehicle.m"), ("k_p", "controller.k_p")))
        [row] = reproduce(published=[Result("5.3", "DIRECT", case, direct(2, 9), 0.9)]).rows
        assert not row.available
        assert "controller.k_p" in row.note

    def test_a_later_method_appears_by_itself(self) -> None:
        # The first available method name is used; unknown options are omitted.
        asked = Search("Later", ("augury", "direct"), 50, (("iterations", 3), ("entrails", "fresh")))
        [row] = reproduce(published=[Result("5.1", "later", UNICYCLE, asked, 0.9)]).rows
        assert row.available
        assert isinstance(row.ours, float)
        assert row.agrees is None, "nothing is stated to hold it to"


class TestHeld:
    def test_out_of_tolerance_breaks(self) -> None:
        [row] = reproduce(published=[Result("5.1", "nominal", UNICYCLE, Fly(), 0.9436, model=Model(0.9, 1e-3))]).rows
        assert row.agrees is False
        assert row.broken

    def test_the_right_value_at_the_wrong_point_breaks(self) -> None:
        model = Model(0.9417, 0.01, (4.0, 0.04), PLACE)
        [row] = reproduce(published=[Result("5.3", "DIRECT", UNICYCLE, direct(20, 500), 0.9, model=model)]).rows
        assert row.agrees is False

    def test_a_failed_simulation_has_no_value(self) -> None:
        # The flight starts at the obstacle: excluded.
        asked = at(UNICYCLE, (5.0, 0.05))
        asked = Fly((*asked.values, ("start.x", 4.0), ("start.y", 4.1)))
        [row] = reproduce(published=[Result("5.1", "nominal", UNICYCLE, asked, 0.9436, model=Model(0.9, 1e-3))]).rows
        assert (row.ours, row.agrees, row.available) == (None, False, True)
        assert row.broken, "it must give a value"
        assert " 0.5 m" in row.note, "it starts within the threshold"


@pytest.mark.parametrize(
    ("costs", "statement"),
    [
        ([1.0, 2.0, 3.0], "rises"),
        ([3.0, 2.0, 1.0], "falls"),
        ([3.0, 2.0, 2.0001, 1.0], "falls"),
        ([3.0, 1.0, 2.0], "neither"),
        ([3.0, np.nan, 2.0], "neither"),
    ],
)
def test_the_direction_of_a_series_is_stated(costs: list[float], statement: str) -> None:
    assert ours.direction(np.array(costs))[0] == statement


class TestRendering:
    def test_the_text_has_every_table(self, made: Reproduction) -> None:
        statement = io.StringIO()
        render.print_text(made, Console(file=statement, width=160))
        shown = statement.getvalue()
        for part in ("Table 5.3. DIRECT, unicycle", "not available", "0.9378", "[6, 0.06]", "0.9435642 ± 2e-06"):
            assert part in shown
        assert render.summary(made) in " ".join(shown.split())

    def test_markdown_tables_are_whole(self, made: Reproduction) -> None:
        lines = render.markdown(made).splitlines()
        rows = [line for line in lines if line.startswith("| ")]
        assert {line.count("|") for line in rows} == {len(render.HEADINGS) + 1}
        assert sum("not available" in line for line in rows) == 1
        assert len(rows) == len(made.rows) + sum(line.startswith("## ") for line in lines)

    def test_counts_add_up(self, made: Reproduction) -> None:
        n = render.counts(made)
        assert n["agree"] + n["disagree"] + n["undecided"] + n["not_available"] == n["rows"]


class TestCommand:
    def test_json_alone_on_standard_output(self, capsys: pytest.CaptureFixture[str]) -> None:
        assert invoke(["reproduce", "--table", "5.3", "--json"]) == 0
        document = json.loads(capsys.readouterr().out)
        assert [row["table"] for row in document["rows"]] == ["5.3"] * 3

    def test_tables_and_figures_are_written(self, tmp_path, capsys: pytest.CaptureFixture[str]) -> None:  # type: ignore[no-untyped-def]
        assert invoke(["reproduce", "--table", "5.3", "--out", str(tmp_path / "new"), "--markdown"]) == 0
        assert "## Table 5.3" in capsys.readouterr().out
        folder = tmp_path / "new"
        assert json.loads((folder / "tables.json").read_text())["rows"]
        assert "## Table 5.3" in (folder / "tables.md").read_text()
        expected = {"3.6", "3.7", "3.8", "5.2", "5.3", "5.4", "6.1"}  # of case 1 alone
        assert {p.stem for p in folder.glob("*.csv")} == {f"figure-{figure}" for figure in expected}
        lines = (folder / "figure-3.7.csv").read_text().splitlines()
        assert [re.findall(r"\[(.+)\]", head) for head in lines[0].split(",")] == [["-"], ["kg"], ["m"]]
        assert len(lines) == 1 + ours.SWEEP
        assert (folder / "figure-6.1.csv").read_text().count("\n") == 1001

    def test_no_such_table_is_wrong_input(self, capsys: pytest.CaptureFixture[str]) -> None:
        assert invoke(["reproduce", "--table", "9.9"]) == WRONG_INPUT
        assert "unknown table '9.9'" in capsys.readouterr().err

    def test_a_broken_row_is_the_exit_code(
        self, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
    ) -> None:
        wrong = Result("5.1", "nominal", UNICYCLE, Fly(), 0.9436, model=Model(0.9, 1e-3))
        monkeypatch.setattr(compare, "RESULTS", (wrong,))
        assert invoke(["reproduce", "--json"]) == VIOLATED
        assert json.loads(capsys.readouterr().out)["counts"]["broken"] == 1

    @pytest.mark.parametrize("options", [[], ["--table", "5.3"], ["--steps"]])
    def test_nothing_computed_is_no_agreement(self, options: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
        for module in (ours, steps):
            monkeypatch.setattr(module, "library", dict)
        assert invoke(["reproduce", "--json", *options]) == VIOLATED

    def test_a_figure_that_is_not_there_is_the_exit_code(
        self, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        def lacking(flights: ours.Flights) -> tuple[list[str], figures.Rows]:
            raise ours.NotAvailable("no such method")

        nominal = Result("5.1", "nominal", UNICYCLE, Fly(), 0.9436)
        monkeypatch.setattr(compare, "RESULTS", (nominal,))
        monkeypatch.setattr(figures, "_figures", lambda cases: {"9.9": lacking})
        (tmp_path / "figure-9.9.csv").touch()
        assert invoke(["reproduce", "--json", "--out", str(tmp_path)]) == VIOLATED
        assert "figure 9.9" in capsys.readouterr().err
        assert not (tmp_path / "figure-9.9.csv").exists(), "of an earlier command"


def test_every_figure_asked_for_is_written() -> None:
    asked = {"3.7", "3.8", *(f"3.{n}" for n in range(20, 28)), "3.32", "3.34", "7.8", "7.9", "7.10"}
    asked |= {"5.7", "5.11", "5.15", "7.14"}  # distances over time
    assert asked <= set(figures.SWEEPS) | set(figures.FLIGHTS)


class TestSteps:
    def test_notes_say_how_often(self) -> None:
        campaign = load_file(library()["unicycle_static"])
        assert steps.declared(campaign) is None
        notes = (
            "One thing.\nStep adequacy: up to 12 of\n200 random points exceed the tolerance, because the force jumps.\n"
        )
        assert steps.declared(campaign.model_copy(update={"notes": notes})) == 0.06

    def test_a_campaign_of_which_no_point_has_a_value_is_not_adequate(self) -> None:
        campaign = load_file(library()["unicycle_static"])
        start = {"x": 4.0, "y": 4.1}  # within the threshold of the obstacle: excluded
        inside = campaign.model_copy(update={"scenario": campaign.given_scenario.model_copy(update={"start": start})})
        assert steps.adequacy("inside", closed_loop(campaign), points=3).ok
        found = steps.adequacy("inside", closed_loop(inside), points=3)
        assert (found.compared, found.ok) == (0, False)


@pytest.mark.parametrize("name", dict.fromkeys(r.case.campaign for r in RESULTS))
def test_published_values_in_the_library_equal_those_in_the_tables(name: str) -> None:
    values = {round(r.published, 4) for r in RESULTS if r.campaign == name and isinstance(r.published, float)}
    told = load_file(library()[name]).published
    assert told
    assert [(p.label, p.value) for p in told if round(p.value, 4) not in values] == []
