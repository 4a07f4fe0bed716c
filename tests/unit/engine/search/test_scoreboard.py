"""The score board in its short form: every part of the harness, and what its figures mean."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest

from tests.bench.scoreboard import __main__ as board
from tests.bench.scoreboard import bbob, cells, niching, page, peers, published, reaching, searches, sureness, verdicts
from tests.bench.scoreboard.bars import ABOUT, BBOB, bars
from tests.bench.scoreboard.cells import Cell, Row
from tests.bench.scoreboard.contestants import Contestant, names, own_names
from tests.bench.scoreboard.fitted import coefficients
from tests.bench.scoreboard.parts import Request, averaged
from tests.given import landscapes
from tests.given.kept_cells import kept_rows
from worker.engine.search.base import Floats
from worker.evidence.verdicts.sureness import chance, model
from worker.running.catalogue.installed import methods

SHORT = ["--only", "landscapes", "--half", "setting", "--seeds", "1", "--processes", "1", "--budgets", "2,4"]

GUIDE = (cells.ROOT / "docs" / "methods.md").read_text(encoding="utf-8")


@pytest.fixture(autouse=True)
def no_digest(monkeypatch: pytest.MonkeyPatch) -> None:
    """The digest of the sources takes longer than the short form."""
    monkeypatch.setattr(cells, "code", lambda names: "one version")


def short(build: Path, methods: str = "direct,nlopt_crs", more: Sequence[str] = ()) -> dict[str, Any]:
    return board.main([*SHORT, "--methods", methods, *more], build)


def test_the_short_form_writes_the_board_and_continues_from_its_cells(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = short(tmp_path)
    assert found["parts"]["landscapes"]["cells"] == 20
    assert json.loads((tmp_path / "scoreboard.json").read_text()) == found
    text = (tmp_path / "scoreboard.md").read_text()
    assert "| NLopt CRS2 | 2." in text
    assert "0 met, 0 missed" in text
    lines = (tmp_path / "scoreboard" / "cells.jsonl").read_text().splitlines()
    file = tmp_path / "scoreboard" / "cells.jsonl"
    file.write_text("\n".join([*lines[:-1], lines[-1][:30]]))  # interrupted while the last cell was written
    made: list[Cell] = []
    part = board.PARTS["landscapes"]

    def counted(cell: Cell) -> dict[str, Any]:
        made.append(cell)
        return part.measure(cell)

    monkeypatch.setitem(board.PARTS, "landscapes", replace(part, measure=counted))
    again = short(tmp_path)
    assert len(made) == 1
    assert again["parts"]["landscapes"]["table"] == found["parts"]["landscapes"]["table"]


def test_a_cell_of_other_code_is_measured_again(tmp_path: Path) -> None:
    file, cell = tmp_path / "cells.jsonl", Cell("bbob", "setting", "direct", "1", 2, 1, (10,))
    for version in ("old", "new"):
        cells.measured([cell], lambda _: {"value": 1.0}, file, 1, {"direct": version})
    assert len(file.read_text().splitlines()) == 2
    assert cells.stored(cells.lines(file), {"direct": "new"})[cell].figures == {"value": 1.0}
    assert not cells.stored(cells.lines(file), {"direct": "newer"})


def test_cells_kept_with_the_code_need_not_be_measured(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file, versions = cells.kept("p", tmp_path / "kept"), {"a": "one", "b": "one"}
    rows = [Row(Cell("p", "judging", m, "f", 2, i, (10,)), {"v": 0.25 * i}, "", 0.125) for m in "ab" for i in (1, 2)]
    failed = Row(Cell("p", "judging", "a", "f", 2, 3, (10,)), {}, "ValueError: no value", 0.5)
    cells.keep([*rows, failed], file, versions)
    known = cells.stored(cells.lines(file), versions)
    assert [*known] == [row.cell for row in rows]
    asked = [rows[0].cell, failed.cell]
    found = cells.measured(asked, None, tmp_path / "cells.jsonl", 1, versions, known)
    assert [row.figures for row in found] == [{"v": 0.25}, {}]
    assert not cells.stored(cells.lines(file), {"a": "two"})
    cells.keep([failed], file, versions)
    assert not file.exists()


def test_what_is_stored_is_shown_without_what_is_missing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    short(tmp_path, "direct,nlopt_crs", ["--functions", "plateaus"])
    short(tmp_path, "direct")
    found = board.main([*SHORT, "--methods", "direct,nlopt_crs", "--stored"], tmp_path, tmp_path / "kept", tmp_path)
    part = found["parts"]["landscapes"]
    assert (part["cells"], part["missing"]) == (20, 9)
    assert {column for column, by in part["table"].items() if "nlopt_crs" in by} == {"plateaus @ 2", "plateaus @ 4"}
    assert all("direct" in by for by in part["table"].values())
    assert ", 9 of them" in page.markdown(found)


@pytest.mark.nightly  # by day the figures that methods and their guide state, below
def test_the_guide_shows_what_the_kept_cells_say() -> None:
    guide = (cells.ROOT / "docs" / "scoreboard.md").read_text(encoding="utf-8")
    for part in board.PARTS.values():
        rows = kept_rows(part)
        if any(row.figures for row in rows):
            section = guide.split(f"## {part.title}\n")[1].split("\n## ")[0]
            assert "\n".join(page.tables(part.table(rows), part.shown)) in section


def test_the_guide_on_methods_has_the_figures_of_the_board() -> None:
    """The table of `auto`: its figures, and the best of the other methods of ours in brackets."""
    table, others = bbob.PART.table(kept_rows(bbob.PART)), [name for name in own_names() if name != "auto"]
    for dimension in bbob.DIMENSIONS:
        stated = []
        for budget in bbob.BUDGETS:
            by = table[f"{dimension} parameters @ {budget}"]
            best = max((name for name in others if name in by), key=lambda name: by[name])
            stated.append(f"{by['auto']:.3f} ({_named(best)} {by[best]:.3f})")
        assert f"| {dimension} | {' | '.join(stated)} |" in GUIDE


def test_the_guide_on_methods_says_how_often_statements_come_true_as_the_board_does() -> None:
    table = {column: by["auto"] for column, by in sureness.PART.table(kept_rows(sureness.PART)).items() if by}
    for low, high in [(0.05, 0.07), (0.07, 0.13), (0.13, 0.3), (0.3, 0.6)]:
        group = f"{100 * low:g} to {100 * high:g} %"
        row = next(line for line in GUIDE.splitlines() if line.startswith(f"| {group} |"))
        _, count, _, stated, true = (part.strip() for part in row.strip("| ").split("|"))
        assert count == f"{table[f'{group}, statements']:,.0f}"
        assert stated == f"{100 * table[f'{group}, stated']:.1f} %"
        assert true.startswith(f"{100 * table[f'{group}, came true']:.1f} % [")


def test_the_guide_on_methods_has_the_chances_of_the_model() -> None:
    lines = GUIDE.splitlines()
    first = next(at for at, line in enumerate(lines) if line.startswith("| evaluations as low"))
    heads, _, *rows = [[part.strip() for part in line.strip("| ").split("|")[1:]] for line in lines[first : first + 4]]
    for parameters, row in zip((4, 3), rows, strict=True):
        found = [100 * chance(np.full(int(head.split()[0]), -1.0), 0.0, model(parameters)) for head in heads]
        assert row == [f"{one:.0f} %" if one >= 10 else f"{one:.1f} %" for one in found]


def test_the_guide_on_methods_has_the_boards_figures_of_niching() -> None:
    table = niching.PART.table(kept_rows(niching.PART))
    ratio, f1 = (table[f"all, {name}"]["auto"] for name in ("peak ratio", "F1"))
    stated = re.search(r"([\d.]+) \(peak ratio; F1 ([\d.]+)", GUIDE)
    assert stated is not None
    assert stated.groups() == (f"{ratio:.2f}", f"{f1:.2f}")


def test_the_guide_on_methods_has_the_boards_figures_of_verdicts_and_loops() -> None:
    rows, stated = kept_rows(verdicts.PART), re.search(r"(\d+) searches (\d+) state", GUIDE)
    measured = [row.figures for row in rows if row.figures]
    assert stated is not None
    assert [*map(int, stated.groups())] == [len(rows), sum(found["found"] for found in measured)]
    assert all(found["not cleared"] for found in measured)
    table = reaching.LOOPS.table([row for row in kept_rows(reaching.LOOPS) if row.figures])
    by = {name: value for name, value in table["all @ 1000"].items() if name in own_names()}
    best = max((name for name in by if name != "auto"), key=by.__getitem__)
    assert re.search(rf"are {by['auto']:.3f} of its searches \({_named(best)} {by[best]:.3f}", GUIDE)
    assert table["all, violated @ 1000"]["auto"] == 1.0


def test_the_figures_that_methods_state_are_those_of_the_board() -> None:
    known = bbob.PART.table(kept_rows(bbob.PART)) | reaching.LANDSCAPES.table(kept_rows(reaching.LANDSCAPES))
    figures = {f"{x:.2f}" for column in ("5 parameters @ 1000", "all @ 1000") for x in known[column].values()}
    stated = {
        name: set(re.findall(r"0\.\d\d", f"{method.suits} {method.drawback}")) for name, method in methods().items()
    }
    assert set().union(*stated.values()) > {"0.72"}
    assert {name: of - figures for name, of in stated.items() if of - figures} == {}


def _named(method: str) -> str:
    title = Contestant(method).title
    return title if title.isupper() or "-" in title else title[0].lower() + title[1:]


@pytest.mark.parametrize("name", published.ORACLES)
def test_published_figures_are_those_of_the_package(name: str) -> None:
    if not (peers.FOLDER / "cocopp").exists():
        pytest.skip("cocopp is not installed")
    assert published.shares(name) == published.FIGURES[name]


def test_only_the_judging_half_is_kept(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        board.main([*SHORT, "--keep"], tmp_path, tmp_path / "kept", tmp_path)
    assert "judging half" in capsys.readouterr().err
    shorter = [word for word in SHORT if word not in ("--half", "setting")]
    found = board.main([*shorter, "--methods", "direct", "--keep"], tmp_path, tmp_path / "kept", tmp_path)
    assert (tmp_path / "scoreboard.md").read_text() == page.markdown(found)
    assert len(cells.lines(tmp_path / "kept" / "landscapes.jsonl.xz")) == 10


def test_a_cell_is_valid_for_its_method_and_what_it_searched() -> None:
    one, loops, runs = (cells.versions(("cma_es", "direct", "scipy_direct"), r) for r in get_args(cells.Reach))
    assert len({*one.values()}) == 3
    for name, version in one.items():
        assert loops[name].startswith(f"{version} ")
        assert runs[name].startswith(f"{version} ")
        assert loops[name] != runs[name]


def test_what_only_whole_runs_have_counts_for_them_alone() -> None:
    files = cells._of_folder(cells.ROOT / cells.HERE)
    assert {file.name for file in files} >= {"bbob.py", "peers.py", "searches.py"}
    assert not {file.name for file in files} & {"sureness.py", "niching.py", "verdicts.py", "page.py", "cells.py"}
    assert all((cells.ROOT / name).is_file() for name in (*cells.WHOLE_RUNS, *cells.PRESENTATION))
    assert all((cells.ROOT / name).exists() for name in cells.RUNS)
    assert cells.ROOT / "worker/evidence/verdicts/sureness.py" in cells._of_folder(cells.ROOT / cells.RUNS[0])


def test_chosen_cells_are_printed_and_repeated_by_their_command(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    short(tmp_path, "direct", ["--functions", "plateaus"])
    first = json.loads(capsys.readouterr().out)
    assert not (tmp_path / "scoreboard.json").exists()
    command = Cell(**{name: first[name] for name in Cell._fields} | {"budgets": (2, 4)}).command
    start, words = command.split()[:3], command.split()[3:]
    assert start[1:] == ["-m", "tests.bench.scoreboard"]
    board.main([*words, "--processes", "1", "--again"], tmp_path)
    assert json.loads(capsys.readouterr().out) == first


def test_an_error_is_stated_and_no_mean_is_taken_over_the_rest(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    part = board.PARTS["landscapes"]

    def fails(cell: Cell) -> dict[str, Any]:
        if cell.method == "direct" and cell.number == 3:
            raise ValueError("no value")
        return part.measure(cell)

    monkeypatch.setitem(board.PARTS, "landscapes", replace(part, measure=fails))
    found = short(tmp_path)
    assert found["parts"]["landscapes"]["errors"] == {"direct": [1, "ValueError: no value"]}
    table, kind = found["parts"]["landscapes"]["table"], [*landscapes.KINDS][3]
    assert {column for column, by in table.items() if "direct" not in by} == {
        f"{group} @ {budget}" for group in ("all", kind) for budget in (2, 4)
    }
    assert all("nlopt_crs" in by for by in table.values())
    assert "- direct: 1 " in page.markdown(found)


def test_every_figure_of_a_part_without_budgets_is_on_the_page() -> None:
    figures = (("counts", 12.0), ("share", 0.5))
    table = {f"{group}, {name}": {"auto": value} for group in "abcde" for name, value in figures}
    rows = [f"| {group} | 12 | 0.500 |" for group in "abcde"]
    assert page.tables(table, "")[2:] == ["| | counts | share |", "|---|---|---|", *rows]


def test_a_method_without_a_figure_in_one_row_has_no_mean() -> None:
    rows = [Row(Cell("p", "setting", m, "f", 2, i), {"v": v}, "", 0.0) for m, i, v in
            (("a", 1, 1.0), ("a", 2, None), ("b", 1, 0.25), ("b", 2, 0.75))]  # fmt: skip
    assert averaged(rows, lambda row: row.figures) == {"v": {"b": 0.5}}


def test_the_targets_of_bbob_are_51() -> None:
    assert bbob.reached(1e3) == 0.0
    assert bbob.reached(100.0) == pytest.approx(1 / 51)
    assert bbob.reached(1e-3 * (1 + 1e-9)) == pytest.approx(25 / 51)
    assert bbob.reached(0.0) == 1.0


def test_bars_are_met_missed_or_not_measured() -> None:
    table = {f"5 parameters @ {b}": {"auto": least, "direct": least} for b, least in BBOB.items()}
    table["5 parameters @ 200"]["direct"] = 0.9
    of_bbob = [bar.verdict for bar in bars({"bbob": table}, ["auto", "direct"]) if bar.part == "bbob"]
    assert of_bbob == ["met", "met", "met", "met", "missed", "met"]  # absolute, then relative to the best other
    assert {bar.verdict for bar in bars({}, ["auto", "direct"])} == {"not measured"}
    kinds = {"plateaus @ 10": {"auto": 0.1, "direct": 0.9}, "plateaus @ 20": {"auto": 0.87, "direct": 0.9}}
    loops = {"a, violated @ 20": {"auto": 0.9, "direct": 1.0}, "b, violated @ 20": {"auto": 0.0, "direct": 0.9}}
    judged = bars({"landscapes": kinds, "loops": loops}, ["auto", "direct"])
    verdicts = [(bar.part, bar.verdict) for bar in judged if bar.part in ("landscapes", "loops")]
    assert verdicts == [("landscapes", "met"), ("loops", "missed")]  # of b, no other method finds enough


def test_a_budget_is_a_run_of_its_own_only_where_points_depend_on_it() -> None:
    def bowl(points: Floats) -> Floats:
        return np.asarray(((points - 0.4) ** 2).sum(axis=1))

    one, several = (Contestant(name).traces(bowl, 2, [20, 60], 1) for name in ("cma_es", "contrast_racing"))
    assert one[20] is one[60]
    assert len(several[20].values) == 20
    assert len(several[60].values) == 60
    assert one[60].lowest(20) >= one[60].lowest(60) > 0.0


def test_costly_methods_and_limits_leave_budgets_out() -> None:
    assert Contestant("turbo").takes(500, 5)
    assert not Contestant("turbo").takes(1000, 10)
    assert not Contestant("lq_cma_es").takes(1000, 2)
    assert Contestant("cma_es").takes(20_000, 20)


def test_a_peer_gets_a_number_where_an_evaluation_fails_and_ends_at_its_budget_or_target() -> None:
    received: list[float] = []

    def peer(evaluations: searches.Evaluations, dimension: int, budget: int, seed: int) -> None:
        received.extend(evaluations(np.array([x])) for x in (0.9, 0.5, 0.95, 0.1, 0.2, 0.3))
        raise ValueError("broken")

    def half_fails(points: Floats) -> Floats:
        return np.where(points[:, 0] > 0.8, np.nan, points[:, 0])

    trace = searches.peer_trace(peer, half_fails, 1, 5, 1)
    assert received == [searches.PENALTY, 0.5, 0.5, 0.1, 0.2]
    assert np.isnan(trace.values[[0, 2]]).all()
    assert (len(trace.values), trace.lowest(3), trace.error) == (5, 0.5, "")
    assert searches.peer_trace(peer, half_fails, 1, 9, 1).error == "ValueError: broken"
    assert len(searches.peer_trace(peer, half_fails, 1, 9, 1, stop=0.1).values) == 4


@pytest.mark.nightly
def test_what_a_search_states_is_decided_by_another_one() -> None:
    part, chosen = board.PARTS["sureness"], {("needles", 4), ("ill-conditioned bowls", 5)}
    made = [c for c in part.cells(Request("setting", ("auto",), 1, (50, 60))) if (c.problem, c.number) in chosen]
    rows = [Row(cell, part.measure(cell), "", 0.0) for cell in made]
    assert len(rows) == 2
    for row in rows:
        assert [budget for budget, *_ in row.figures["statements"]] == [50, 50, 60, 60]
    table = part.table(rows)
    assert table["needles, statements"] == {"auto": 4.0}
    groups = [name.removesuffix(", statements") for name in table if name.endswith("%, statements")]
    assert sum(table[f"{name}, statements"]["auto"] for name in groups) == 8.0
    assert ABOUT.removesuffix(", came true") in groups


def test_coefficients_are_those_of_which_the_statements_were_drawn() -> None:
    random = np.random.default_rng(1)
    near = random.uniform(0.0, 2.0, 20_000)
    lower = random.random(20_000) < 1.0 / (1.0 + np.exp(0.5 + 1.5 * near))
    assert coefficients(near, lower) == pytest.approx([-0.5, -1.5], abs=0.1)


def test_a_bar_may_have_two_ends() -> None:
    verdicts = {}
    for true in (0.05, 0.1, 0.2):
        (bar,) = (b for b in bars({"sureness": {ABOUT: {"auto": true}}}, ["auto"]) if b.part == "sureness")
        verdicts[true] = bar.verdict
    assert verdicts == {0.05: "missed", 0.1: "met", 0.2: "missed"}


def test_what_is_not_installed_is_reported_and_takes_no_part(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    missing = replace(peers.PEERS["nlopt_crs"], modules=("a_package_that_nothing_installs",))
    monkeypatch.setitem(peers.PEERS, "nlopt_crs", missing)
    found = short(tmp_path)
    assert found["parts"]["landscapes"]["cells"] == 10
    assert "| NLopt CRS2 | not installed |" in (tmp_path / "scoreboard.md").read_text()


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--only", "bobb"], "bobb"),
        (["--methods", "simplex"], "simplex"),
        (["--seeds", "0"], "at least 1"),
    ],
)
def test_arguments_that_are_not_possible_are_refused(
    words: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        board.main(words)
    assert sentence in capsys.readouterr().err


def test_every_part_has_cells_of_both_halves_with_different_numbers() -> None:
    for part in board.PARTS.values():
        numbers = {}
        for half in ("setting", "judging"):
            made = part.cells(Request(half, ("contrast_racing", "auto"), 2))
            assert made
            assert len(set(made)) == len(made)
            numbers[half] = {(cell.half, cell.number) for cell in made}
        assert not numbers["setting"] & numbers["judging"]
    assert set(own_names()) < set(names())


@pytest.mark.skipif(not bbob.available(), reason=f"BBOB needs ioh: {peers.INSTALL}")
def test_the_short_form_of_bbob() -> None:
    for method in ("direct", "pycma_bipop"):
        found = bbob.share(method, functions=(1, 8, 15), instances=(1,), dimension=2, budgets=(5, 20))
        assert found == bbob.share(method, functions=(1, 8, 15), instances=(1,), dimension=2, budgets=(5, 20))
        assert 0.0 < found[5] <= found[20] < 1.0
    function = bbob.OnCube(1, 1, 3)
    optimum = (np.array(function.problem.optimum.x) + 5.0) / 10.0
    assert function(optimum[None, :])[0] == 0.0
    assert (function(np.random.default_rng(1).random((50, 3))) > 0.0).all()
