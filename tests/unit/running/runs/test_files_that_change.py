"""Files of a simulator that change while a run uses them: no result of a stage, and no block, is stored of them."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.sample_seed import SampleSeed
from campaigns.stored.records import Ahead, Columns
from campaigns.versions import OtherCode
from tests.given.at_night import nightly_but
from worker.engine.problem.problem import Problem
from worker.engine.systems import optional
from worker.engine.systems.base import CampaignUnusable
from worker.engine.systems.simulators import ours
from worker.engine.systems.simulators.declared import unchanged as simulated
from worker.engine.systems.simulators.declared.folder import FOLDERS
from worker.engine.systems.simulators.declared.unchanged import Unchanged
from worker.engine.systems.simulators.pooled import Pooled
from worker.engine.systems.simulators.simulated import Simulated
from worker.running.catalogue.installed import forget_simulators
from worker.running.opening import opened
from worker.running.runs import begun, file_check, repetition
from worker.running.runs.file_check import FilesChanged
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

PROGRAM = """
import json, sys
for line in sys.stdin:
    print(json.dumps({"results": {"d": 1.0 + json.loads(line)["parameters"]["x"]}}), flush=True)
"""
DESCRIPTOR = """
name: bowl
command: ["{python}", "-S", "{folder}/bowl.py"]
parameters: {x: {nominal: 0.5, low: 0, high: 1}}
results: {d: {}}
slots: 1
"""
FUNCTION = """
import clearance

@clearance.simulator(parameters={"x": clearance.Parameter(0, 1)}, results={"d": clearance.Output()}, isolated=ISOLATED)
def bowl(x):
    return 1.0 + x
"""
KINDS = ("program", "isolated function", "function in this process")
CHANGED = r"bowl\.py has changed since this run opened it; start the run again"


SOME = nightly_but(("program", "function in this process"), KINDS)
"""By day an isolated function, which needs a process of Clearance, in the tests that a kind can answer otherwise."""


@pytest.fixture(params=KINDS)
def file(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The file of an installed simulator, which it does not look at itself before hours have passed."""
    monkeypatch.setattr(simulated, "PAUSE", 1e5)
    made = tmp_path / "bowl.py"
    if request.param == "program":
        made = tmp_path / "bowl" / "bowl.py"
        made.parent.mkdir()
        (made.parent / "simulator.yaml").write_text(DESCRIPTOR)
    function = FUNCTION.replace("ISOLATED", str(request.param == "isolated function"))
    made.write_text(PROGRAM if request.param == "program" else textwrap.dedent(function))
    monkeypatch.setenv(FOLDERS, str(tmp_path))
    forget_simulators()
    yield made
    monkeypatch.undo()
    forget_simulators()


def edited(file: Path) -> None:
    file.write_text(file.read_text() + "# edited\n")


def campaign(**simulator: Any) -> Campaign:
    stages = {"sensitivity": None, "search": [{"method": "direct", "evaluations": 5}], "validate": {"neighbours": 0}}
    return load_document(
        {
            "name": "Bowl",
            "simulator": {"name": "bowl", **simulator},
            "uncertain": {"simulator.x": {"low": 0.0, "high": 1.0}},
            "criterion": {"result": "d", "threshold": 0.5},
            "stages": stages,
        }
    )


@dataclass
class Editing(MemoryStore):
    """A store at whose first evaluations something is done to a file."""

    done: Callable[[], object] = field(default=lambda: None)

    def append(self, position: int, first: int, columns: Columns, ahead: Ahead | None = None) -> None:
        if not self.chunks:
            self.done()
        super().append(position, first, columns, ahead)


@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    ("asked", "pause"),
    [pytest.param({}, 1e5, marks=pytest.mark.nightly), ({"retries": 1}, 0.0)],
    ids=["it does not look", "it looks"],
)
def test_a_run_whose_files_changed_stores_nothing_more_and_continues_once_they_are_back(
    file: Path, asked: dict[str, Any], pause: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = file.read_text()
    seed = SampleSeed.drawn()
    undisturbed = MemoryStore(sample_seed=seed)
    execute(campaign(**asked), undisturbed)
    monkeypatch.setattr(simulated, "PAUSE", pause)
    store = Editing(sample_seed=seed, done=lambda: edited(file))
    with pytest.raises(FilesChanged, match=CHANGED):
        execute(campaign(**asked), store)
    assert store.verdict is None
    assert not any(stage.result for stage in store.stages)
    assert {at: len(chunks) for at, chunks in store.chunks.items()} == {0: 1}, "of before the edit"
    file.write_text(text)
    store.done = lambda: None
    execute(campaign(**asked), store)
    for at in undisturbed.chunks:
        one, other = store.evaluations(at), undisturbed.evaluations(at)
        assert one is not None
        assert other is not None
        assert (one.costs.tolist(), one.status.tolist()) == (other.costs.tolist(), other.status.tolist())


@pytest.mark.by_day(1)
@pytest.mark.parametrize("file", SOME, indirect=True)
def test_a_run_whose_simulator_cannot_be_opened_since_an_edit_waits_for_its_files(file: Path) -> None:
    """That it has changed is known before it is opened."""
    text, store = file.read_text(), MemoryStore()
    execute(campaign(), store)
    assert store.versions is not None
    known = begun.Begun(store.versions, {})
    document = campaign().document()
    assert begun.readable(document, "a run", known) == campaign()
    file.write_text(text + "raise ImportError\n")
    with pytest.raises(OtherCode, match="simulators/bowl has changed"):
        begun.readable(document, "a run", known)
    file.write_text(text)
    assert begun.readable(document, "a run", known) == campaign()


def test_a_change_before_the_first_evaluation_is_no_fault_of_the_campaign(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is examined before the first stage fails then, for another reason."""

    def examined(*_: object) -> None:
        edited(file)
        raise CampaignUnusable([])

    monkeypatch.setattr(repetition, "check", examined)
    store = MemoryStore()
    with pytest.raises(FilesChanged, match=CHANGED):
        execute(campaign(), store)
    assert not store.stages


@pytest.mark.by_day(1)
@pytest.mark.parametrize("file", SOME, indirect=True)
def test_files_that_only_look_changed_do_not_matter(file: Path) -> None:
    store = Editing(done=lambda: os.utime(file, ns=(1, 1)))
    execute(campaign(), store)
    assert store.verdict is not None


@pytest.fixture
def problem(file: Path) -> Iterator[Problem]:
    found = opened.problem(campaign())
    yield found
    optional.close(found.system)


def test_a_change_between_the_opening_and_the_first_evaluation_is_one(problem: Problem, file: Path) -> None:
    """The digest may be of the files before or after it."""
    edited(file)
    assert isinstance(problem.system, Simulated)
    assert problem.system.changed(now=True)
    fresh = problem.system.fresh()
    assert isinstance(fresh, Simulated)
    assert fresh.changed(), "what is made of it has the same files"


def test_a_change_of_the_same_size_and_time_is_seen(problem: Problem, file: Path) -> None:
    known, text = file.stat(), file.read_text()
    file.write_text(text.replace("1.0", "9.0"))
    os.utime(file, ns=(known.st_atime_ns, known.st_mtime_ns))
    with pytest.raises(FilesChanged, match=CHANGED):
        file_check.check(problem)


def test_a_worker_that_assists_stores_no_block_after_a_change(problem: Problem, file: Path) -> None:
    store = MemoryStore()
    assisted = file_check.Checked(store, problem)
    assisted.count(0, [])
    assert store.counted == {0: []}
    edited(file)
    with pytest.raises(FilesChanged, match=CHANGED):
        assisted.count(1, [])
    assert store.counted == {0: []}
    assert assisted.found() == []


OF_SLOTS = {
    "function": ("slots/child.py", "calling.py", "declared.function", "declared.excluded"),
    "files": ("slots/child.py", "slots.files", "declared.excluded"),
    "FMU": ("slots/child.py", "fmus.process"),
}
"""What the process of a slot loads of ours: files, and modules with all that they import."""
LOADED = """
import importlib, sys
for name in sys.argv[1:]:
    importlib.import_module(name)
ours = [m for name, m in sys.modules.items() if name.partition(".")[0] in ("worker", "campaigns", "backend")]
print(*sorted(module.__file__ for module in ours), sep="\\n")
"""


@pytest.mark.parametrize("kind", OF_SLOTS)
def test_every_file_of_ours_that_a_slot_loads_is_looked_at(kind: str) -> None:
    package = "worker.engine.systems.simulators"
    modules = [f"{package}.{name}" for name in OF_SLOTS[kind] if not name.endswith(".py")]
    done = subprocess.run([sys.executable, "-c", LOADED, *modules], capture_output=True, text=True, check=True)
    place = ours.FILES[0].parent
    loaded = {Path(line) for line in done.stdout.splitlines()}
    files = {place / name for name in OF_SLOTS[kind] if name.endswith(".py")}
    assert len(loaded) >= len(modules)
    assert loaded | files <= {*ours.FILES}


def test_a_release_in_mid_run_reaches_no_slot(
    problem: Problem, file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A process of a slot starts with the code that is there by then."""
    child = tmp_path / "child.py"
    child.write_text("X = 1.0\n", encoding="utf-8")
    monkeypatch.setattr(ours, "_OURS", Unchanged([child]))
    file_check.check(problem)
    child.write_text("X = 2.0\n", encoding="utf-8")
    if isinstance(problem.system, Pooled):
        with pytest.raises(FilesChanged):
            file_check.check(problem)
        assert problem.system.submit(problem.system.nominal).result().reason == ours.changed()
    else:
        file_check.check(problem)
