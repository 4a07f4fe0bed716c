"""`clearance verify`: it agrees on real runs, notices what contradicts the evaluations, and stays short."""

from __future__ import annotations

import ast
import gzip
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa

from clearance.cli import VIOLATED, WRONG_INPUT, invoke
from tests.audited import shortly
from tests.unit.records import CALLS, CORRUPTIONS, FINDING, RUNS, Folder, edit, write_called, written
from worker.engine.stages.parts import offered
from worker.evidence.audit import verify as program
from worker.evidence.audit.binomial import upper_bound
from worker.evidence.audit.verify import Run, verify

DATABASES = Path(__file__).parents[1] / "api" / "stored"
ROOM = Path(program.__file__)
OTHERS = {
    "a changed bound of a stage", "another probability outside", "a changed quantile", "a changed order",
    "a finding at no bound", "another parameter", "few spot checks", "unseen violations",
    "a better best", "another end of a search", "a smaller spread",
}  # fmt: skip
"""Corruptions that only the audit notices: statements that the verdict does not use, or that verify takes as stored."""

MORE: list[tuple[str, str, Callable[[Folder], Any]]] = [
    ("a point outside the bounds", "cleared", lambda f: f.arrays["points_2"].__setitem__((3, 0), 1.5)),
    ("an evaluation of no stage", "cleared", lambda f: f.result["stages"].pop()),
    ("a finding of fewer parameters", "violated", lambda f: f.result["findings"][0]["point"].pop()),
    ("a finding of no cost", "violated", edit(f"{FINDING}/cost", None)),
    ("a finding listed twice", "cleared", lambda f: f.result["findings"].append(f.result["findings"][0])),
    ("a cost of another type", "cleared", edit("result/worst/cost", "0.94")),
    ("a cost that is NaN", "cleared", edit("result/worst/cost", float("nan"))),
    ("no statistics", "cleared", edit("result/statistics", None)),
    ("another seed, without the counts", "cleared", lambda f: (f.campaign.update(seed=9), f.result.pop("evaluations"))),
    ("no checks", "cleared", edit("result/checks", [])),
    ("no findings", "cleared", edit("result/findings", [])),
    ("a nominal case that is not evaluated again", "cleared", edit("evidence/results/5/nominal", None)),
    ("an unknown status", "cleared", edit("arrays/status_2/3", 9)),
    ("no components", "cleared", lambda f: f.evidence.pop("components")),
    ("no results", "cleared", edit("evidence/results", [])),
]  # fmt: skip


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fewer simulations with the reference integrator, as in the tests of the audit."""
    monkeypatch.setattr(offered, "SPOT_CHECKS", 2)
    monkeypatch.setattr(offered, "AT_MOST", 3)


@pytest.mark.parametrize("name", RUNS)
def test_it_follows(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["verify", str(written(tmp_path / "out", name))]) == 0
    (said,) = capsys.readouterr().out.splitlines()
    assert said.startswith("The verdict ")
    assert " follows from the " in said
    assert "; not checked: words" in said


CHANGED = [(label, name, change) for label, name, change, item in CORRUPTIONS if not item.startswith("sentence.")]
NOTICED = [(name, change) for label, name, change in CHANGED + MORE if label not in OTHERS]
LABELS = [label for label, _, _ in CHANGED + MORE if label not in OTHERS]


@pytest.mark.parametrize(("name", "change"), NOTICED, ids=LABELS)
def test_a_corrupted_record_is_noticed(name: str, change: Callable[[Folder], Any], tmp_path: Path) -> None:
    folder = Folder(written(tmp_path / "out", name))
    change(folder)
    folder.write()
    follows, sentences = verify(shortly(folder.path))
    assert not follows, sentences
    assert all(": stated " in said or " not " in said or "malformed" in said for said in sentences), sentences


@pytest.mark.parametrize(("name", "label", "change"), [c[:3] for c in CALLS if c[1] not in OTHERS])
def test_a_corrupted_record_of_calls_is_noticed(
    name: str, label: str, change: Callable[[Folder], Any], tmp_path: Path
) -> None:
    folder = Folder(write_called(tmp_path, name))
    assert verify(shortly(tmp_path))[0]
    change(folder)
    folder.write()
    assert not verify(shortly(tmp_path))[0], label


def test_it_names_the_stated_and_the_recomputed_value(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = Folder(written(tmp_path / "out", "cleared"))
    folder.set("result/nominal/cost", 0.75)
    folder.write()
    assert invoke(["verify", str(folder.path)]) == VIOLATED == 1
    cost = float(folder.arrays["costs_0"][0, 0])
    assert capsys.readouterr().out == f"Nominal.cost: stated 0.75, recomputed {cost}.\n"


@pytest.mark.parametrize("revision", ["0009", "0010"])
def test_databases_of_earlier_versions_are_read(revision: str, tmp_path: Path) -> None:
    file = tmp_path / "clearance.sqlite3"
    file.write_bytes(gzip.decompress((DATABASES / f"revision-{revision}.sqlite3.gz").read_bytes()))
    engine = sa.create_engine(f"sqlite:///{file}")
    try:
        told = {run_id: verify(shortly(engine, None, run_id)) for run_id in (1, 2)}
    finally:
        engine.dispose()
    assert told[1][0], "its finding holds the evaluations that confirm it"
    if revision == "0009":
        assert told[2] == (False, [
            "it is not known whether the verdict follows",
            "nominal is not stored by the version that made this run",
        ])  # fmt: skip
    else:
        assert told[2][0], told


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("result.json", b"{"), ("result.json", b"[]"), ("result.json", b'{"stages": 3}'), ("evaluations.npz", b"PK"),
        ("evaluations.npz", b""), ("campaign.json", b"{}"), ("result.json", None), ("evaluations.npz", None),
    ],
)  # fmt: skip
def test_what_cannot_be_read_is_wrong_input(name: str, content: bytes | None, tmp_path: Path) -> None:
    folder = written(tmp_path / "out", "inconclusive")
    if content is None:
        (folder / name).unlink()
    else:
        (folder / name).write_bytes(content)
    assert invoke(["verify", str(folder)]) == WRONG_INPUT


def test_a_run_that_is_not_there_is_wrong_input(tmp_path: Path) -> None:
    assert invoke(["verify", "R-0009", "--data", str(tmp_path / "nowhere")]) == WRONG_INPUT
    assert invoke(["verify", str(tmp_path)]) == WRONG_INPUT


@pytest.mark.parametrize(("violations", "samples"), [(0, 1), (0, 3000), (7, 300), (299, 300), (300, 300), (5, 10)])
def test_its_bound_is_that_of_the_audit(violations: int, samples: int) -> None:
    for confidence in (0.9, 0.975):
        mine = program.upper_bound(violations, samples, confidence)
        assert mine == pytest.approx(upper_bound(violations, samples, confidence), rel=1e-10)


def test_it_is_short_and_uses_nothing_of_ours_but_the_campaign() -> None:
    text = ROOM.read_text(encoding="utf-8")
    assert len(text.splitlines()) < 300
    nodes = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Import | ast.ImportFrom)]
    ours = ("backend", "campaigns", "clearance", "worker")
    names = {node.module or "" if isinstance(node, ast.ImportFrom) else node.names[0].name for node in nodes}
    assert {name for name in names if name.split(".")[0] in ours} == {"campaigns.asked.spec"}
    assert not [node for node in nodes if isinstance(node, ast.ImportFrom) and node.level]
    functions = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.FunctionDef)]
    assert max((node.end_lineno or 0) - node.lineno for node in functions) < 30
    assert Run.__doc__
