"""`clearance replay`: stored evaluations give the same bits again, and whatever else happens is said."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from backend.db.engine import connect
from backend.db.queue import submit
from campaigns.refusals import RefusalCode
from campaigns.results.base import EXCLUDED
from campaigns.versions import Processor, Versions
from clearance.cli import VIOLATED, WRONG_INPUT, invoke
from clearance.cli.replay import Again
from tests.given.at_night import nightly_but
from tests.given.corrupted_records import CERTIFY, RUNS, Folder, write_called, written
from tests.given.refused_commands import refusal, refused
from tests.migrated import migrated
from tests.simulators.adversaries import adversary
from worker.engine.stages.parts import offered
from worker.evidence.audit import judge
from worker.running.runs.replay import other_machine

SEARCH = 2
"""The position of the first search in the plan of these runs."""


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fewer simulations with the reference integrator, as in the tests of the audit."""
    monkeypatch.setattr(offered, "SPOT_CHECKS", 2)
    monkeypatch.setattr(offered, "AT_MOST", 3)
    monkeypatch.setattr(judge.audit, "__defaults__", (judge.NOTHING, offered.AT_MOST, offered.SPOT_CHECKS))


def replayed(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, Any]:
    """The exit code, and what is printed with --json."""
    capsys.readouterr()
    code = invoke(["replay", *arguments, "--json"])
    return code, json.loads(capsys.readouterr().out)


def test_findings_have_the_same_bits(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = written(tmp_path / "out", "violated")
    labels = [f["label"] for f in json.loads((folder / "result.json").read_text())["findings"]]
    code, statement = replayed(capsys, str(folder))
    assert (code, statement["agrees"], statement["differences"]) == (0, True, [])
    assert [case["case"] for case in statement["cases"]] == labels != []
    assert all(case["agreement"] == "same bits" and case["now"] == {**case["stored"], "reason": None}
               for case in statement["cases"])  # fmt: skip
    assert invoke(["replay", str(folder), "F1"]) == 0
    line, closing = capsys.readouterr().out.splitlines()
    assert line.startswith("F1: stored d_min 0.")
    assert line.endswith(" m: same bits")
    assert closing == Again(cast("Any", None), [], [True], [], [], "").closing()


def test_a_sample_is_simulated_with_its_own_noise(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = Folder(written(tmp_path / "out", "noisy"))
    draws = folder.evidence["results"][CERTIFY]["drawn_realisations"]
    rows = [0, draws // 2, draws - 1, draws, draws + 1]  # the last two are of the grid
    names = [f"certify:{row}" for row in rows] + [f"{SEARCH}:0"]
    code, statement = replayed(capsys, str(folder.path), *names)
    assert code == 0, statement
    folder.evidence["results"][CERTIFY]["drawn_realisations"] = 0
    folder.write()
    code, statement = replayed(capsys, str(folder.path), *names)
    assert code == VIOLATED
    assert [case["agrees"] for case in statement["cases"]] == [False] * 3 + [True] * 3


@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    "name", nightly_but(("counted", "counted exclusions"), ["counted", "counted noise", "counted exclusions"])
)
def test_blocks_of_a_sample_are_flown_again_from_their_indices(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = Folder(written(tmp_path / "out", name))
    code, statement = replayed(capsys, str(folder.path), "--blocks", "5")
    assert code == 0, statement
    assert statement["cases"] == []
    assert len({block["first"] for block in statement["blocks"]}) == 5
    assert {block["agreement"] for block in statement["blocks"]} == {"same bits"}
    (certified,) = (result for result in folder.evidence["results"] if result["stage"] == "certify")
    blocks = certified["blocks"]
    every = len(blocks["draws"])
    assert sum(blocks["draws"]) == certified["evaluations"]
    blocks["violations"][7] += 1
    folder.write()
    code, statement = replayed(capsys, str(folder.path), "--blocks", str(every))
    assert code == VIOLATED  # although the bits are the same
    assert [block["agreement"] for block in statement["blocks"]].count("differs") == 1
    blocks["digests"] = ["0" * 32 for _ in blocks["digests"]]
    blocks["counts"][0] += 1
    blocks["counts"][-1] -= 1
    folder.write()
    code, statement = replayed(capsys, str(folder.path), "--blocks", "5")
    assert code == VIOLATED  # the bits are others
    folder.result["versions"]["cpu"]["target"] = "another"
    folder.write()
    code, statement = replayed(capsys, str(folder.path), "F1", "--blocks", str(10 * every))
    assert code == VIOLATED
    differing = [block for block in statement["blocks"] if block["agreement"] == "differs"]
    assert [block["whole"] for block in differing] == [False, True]
    assert len(statement["blocks"]) == every + 1
    assert [case["case"] for case in statement["cases"]] == ["F1"]


def test_a_run_without_blocks_has_none_to_fly_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = written(tmp_path / "out", "violated")
    assert invoke(["replay", str(folder), "--blocks", "1"]) == WRONG_INPUT
    assert refusal(capsys.readouterr().err) == RefusalCode.NO_SUCH_CASE


@pytest.mark.parametrize(
    ("name", "code", "statement"),
    [
        ("differs", 0, "The run measured that its simulator does not repeat (by up to "),
        ("violated", VIOLATED, "The campaign states several calls for each evaluation, "),
    ],
)
def test_a_simulator_that_does_not_repeat_is_reported_as_such(
    name: str, code: int, statement: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "out").mkdir()
    folder = write_called(tmp_path / "out", name)
    with adversary("a coin"):
        assert invoke(["replay", str(folder), "F1"]) == code
    assert statement in capsys.readouterr().out
    assert invoke(["replay", str(folder), "F1"]) == WRONG_INPUT
    errors = capsys.readouterr().err
    assert refusal(errors) == RefusalCode.NOT_EVALUABLE
    assert " simulator.name: " in errors


@pytest.mark.parametrize(("factor", "here", "elsewhere"), [(1 + 2e-16, VIOLATED, 0), (1 + 1e-7, VIOLATED, VIOLATED)])
def test_a_changed_cost_is_noticed(
    factor: float, here: int, elsewhere: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = Folder(written(tmp_path / "out", "violated"))
    folder.arrays[f"costs_{SEARCH}"][3] *= factor
    folder.write()
    assert invoke(["replay", str(folder.path), f"{SEARCH}:3"]) == here
    assert capsys.readouterr().out.splitlines()[-1].endswith("1 of 1 do not agree.")
    folder.result["versions"]["cpu"]["target"] = "another"
    folder.write()
    assert invoke(["replay", str(folder.path), f"{SEARCH}:3", "--json"]) == elsewhere
    (difference,) = json.loads(capsys.readouterr().out)["differences"]
    assert "another" in difference


def test_an_evaluation_without_a_cost_agrees_by_its_status(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = Folder(written(tmp_path / "out", "excluded"))
    row = int(np.flatnonzero(folder.arrays[f"status_{SEARCH}"] == EXCLUDED)[0])
    code, found = replayed(capsys, str(folder.path), f"{SEARCH}:{row}")
    (case,) = found["cases"]
    assert (code, case["stored"]["status"], case["now"]["status"], case["agrees"]) == (0, "excluded", "excluded", True)
    folder.arrays[f"status_{SEARCH}"][row] = 0
    folder.arrays[f"costs_{SEARCH}"][row] = 1.0
    folder.write()
    assert invoke(["replay", str(folder.path), f"{SEARCH}:{row}"]) == VIOLATED
    assert ": stored d_min 1.0 m; now excluded (" in capsys.readouterr().out.splitlines()[0]


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("F99", "'F99' is no finding of it (it has F1"),
        ("direct:100000", "stage direct has 1"),
        ("search:0", "search names several stages: 0:INDEX for nominal"),
        ("turbo:0", "turbo is no stage of it"),
        ("direct:-1", "is no finding of it"),
        ("99:0", "99 is no stage of it"),
        ("²:0", "is no finding of it"),
    ],
)
def test_an_unknown_case_is_a_sentence(name: str, why: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = written(tmp_path / "out", "violated")
    assert invoke(["replay", str(folder), name]) == WRONG_INPUT
    assert why in capsys.readouterr().err


def test_what_is_not_a_run_is_a_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert refused(capsys, "replay", tmp_path) == RefusalCode.NO_RUN
    folder = written(tmp_path / "out", "violated")
    for name, text in (("evidence.json", '{"results": [3]}'), ("evidence.json", "[]"), ("result.json", "[]")):
        (folder / name).write_text(text)
        assert invoke(["replay", str(folder)]) == WRONG_INPUT
        assert "cannot be replayed" in capsys.readouterr().err


def test_a_run_that_has_not_begun_has_nothing_to_replay(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    engine = connect(migrated(tmp_path))
    with engine.begin() as connection:
        submit(connection, RUNS["violated"](), name="a", tags=[], owner="ada", planned=1)
    engine.dispose()
    assert refused(capsys, "replay", "R-0001", "--data", tmp_path) == RefusalCode.NO_SUCH_CASE
    assert refused(capsys, "replay", "R-0002", "--data", tmp_path) == RefusalCode.NO_RUN


def test_a_machine_is_of_the_same_kind_only_where_that_is_known() -> None:
    here = Versions(system="Linux x86_64", lanes=8, step=0.01, cpu=Processor(target="znver4", features="avx2"))
    assert other_machine(here, here) == []
    assert other_machine(Versions(), here) == ["the processor of the run is not known"]
    for change in ({"system": "Darwin arm64"}, {"lanes": 16}, {"cpu": Processor(target="znver4", features="avx512f")}):
        assert len(other_machine(here.model_copy(update=change), here)) == 1


def forge(folder: Folder, row: int) -> str:
    """Make one cost of the first search harmless, in the arrays and in the table, with every digest computed again;
    returns its case."""
    before = float(folder.arrays[f"costs_{SEARCH}"][row, 0])
    folder.arrays[f"costs_{SEARCH}"][row, 0] = before + 1e-3
    table = folder.path / "evaluations.csv"
    text = table.read_text(encoding="utf-8")
    assert text.count(repr(before)) == 1
    table.write_text(text.replace(repr(before), repr(before + 1e-3)), encoding="utf-8")
    folder.reseal()
    return f"{SEARCH}:{row}"


@pytest.mark.nightly
def test_an_audit_that_replays_finds_a_forged_cost(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = Folder(written(tmp_path / "out", "cleared"))
    path, count = str(folder.path), sum(len(a) for name, a in folder.arrays.items() if name.startswith("status_"))
    assert invoke(["audit", path, "--replay", "5", "--json"]) == 0
    cases = [case["case"] for case in json.loads(capsys.readouterr().out)["replay"]["cases"]]
    labels = [finding["label"] for finding in folder.result["findings"]]
    assert cases[1 : 1 + len(labels)] == labels
    assert cases[0] == replayed(capsys, path, "0:0")[1]["cases"][0]["case"]
    assert len({*cases}) == 6 + len(labels)
    costs = folder.arrays[f"costs_{SEARCH}"][:, 0]
    case = forge(folder, int(np.argsort(costs)[len(costs) // 2]))
    assert invoke(["audit", path]) == 0, "costs are taken as given"
    code, alone = replayed(capsys, path, case)
    assert code == VIOLATED
    name = alone["cases"][0]["case"]
    assert invoke(["audit", path, "--replay", str(count), "--json"]) == VIOLATED
    found = json.loads(capsys.readouterr().out)["replay"]["cases"]
    assert (len(found), [one["case"] for one in found if not one["agrees"]]) == (count + len(labels), [name])
    assert invoke(["audit", path, "--replay", str(count)]) == VIOLATED
    assert sum(line.startswith(f"{name}: ") for line in capsys.readouterr().out.splitlines()) == 1
