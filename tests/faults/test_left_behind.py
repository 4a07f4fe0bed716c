"""Nothing that a simulator started outlives its run: no process and no folder, whatever ends the run."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa
import yaml

from backend.db.engine import connect
from backend.db.queue import request_cancel, submit
from campaigns.asked.load import load_document
from tests.faults.nodes import cluster
from tests.faults.processes import CLEARANCE, Started, alive, command_of, kill, started, until, worker
from tests.faults.serving import state
from tests.fmu import made
from tests.migrated import migrated
from worker.engine.systems.simulators.cluster.address import SETTING
from worker.engine.systems.simulators.cluster.node import LOST
from worker.engine.systems.simulators.slots.guard import PLACE
from worker.engine.systems.simulators.slots.pool import SlotPool
from worker.engine.systems.simulators.slots.program import Program
from worker.engine.systems.simulators.slots.slot import GUARD

pytestmark = pytest.mark.nightly  # by day tests/faults/test_worker.py: a worker that is killed

HELPERS = "86397.5"
"""How long the helpers sleep [s]; they are found by it."""

WRAPPER = f"""#!/bin/sh
sleep {HELPERS} &
setsid sleep {HELPERS} &
env -i setsid sleep {HELPERS} &
exec "$@"
"""
LINES = """
import json, sys, time
for line in sys.stdin:
    time.sleep(0.02)
    print(json.dumps({"results": {"d": 2.0 - json.loads(line)["parameters"]["a"]}}), flush=True)
"""
FILES = "import json, sys; json.dump({'d': 2.0 - json.load(open(sys.argv[1]))['a']}, open(sys.argv[2], 'w'))"
FUNCTION = """
import subprocess, time
import clearance

STARTED = []

@clearance.simulator(
    name="helped", isolated=ISOLATED, parameters={"a": (0.0, 1.0)}, results={"d": clearance.Output(unit="m")}
)
def fly(a):
    if not STARTED:
        STARTED.append(subprocess.Popen([WRAPPER, "true"]))
    time.sleep(0.02)
    return 2.0 - a
"""
KINDS = ("lines", "files", "function", "in process", "fmu", "node")
"""Those of a node are lines, on a cluster of one process, which has slots of its own."""


def helpers(but: frozenset[int] = frozenset()) -> set[int]:
    """The helpers that run."""
    numbers = {int(entry) for entry in os.listdir("/proc") if entry.isdigit()}
    return {n for n in numbers - but if command_of(n).startswith(f"sleep {HELPERS}") and alive(n)}


class Site:
    """A folder with one simulator of a kind that starts helpers, and the runs of it."""

    def __init__(self, folder: Path, kind: str, evaluator: str = "") -> None:
        self.folder, self.evaluator = folder, evaluator
        self.temporary = folder / "temporary"
        self.simulators = folder / "simulators"
        for empty in (self.temporary, self.simulators):
            empty.mkdir()
        varied, low, high = self._install(kind)
        self.document = {
            "name": "helped",
            "simulator": {"name": "helped"},
            "uncertain": {f"simulator.{varied}": {"low": low, "high": high}},
            "criterion": {"result": "d", "threshold": 0.5},
            "stages": {"search": [{"method": "monte_carlo", "evaluations": 20_000}], "certify": None},
        }

    @property
    def environment(self) -> dict[str, str]:
        given = {"TMPDIR": str(self.temporary), "CLEARANCE_SIMULATORS": str(self.simulators)}
        return given | ({SETTING: self.evaluator} if self.evaluator else {})

    def folders(self) -> list[str]:
        """What there is for temporary files."""
        return sorted(os.listdir(self.temporary))

    def queued(self) -> tuple[sa.Engine, int]:
        """A new database with a run."""
        url = migrated(self.folder)
        engine = connect(url)
        with engine.begin() as connection:
            campaign = load_document(self.document)
            return engine, submit(connection, campaign, name="helped", tags=[], owner="", planned=20_000)

    def _install(self, kind: str) -> tuple[str, float, float]:
        """Its parameter and the bounds."""
        described: dict[str, Any]
        wrapper = self.folder / "wrapper.sh"
        wrapper.write_text(WRAPPER)
        wrapper.chmod(0o755)
        if kind in ("function", "in process"):
            text = FUNCTION.replace("ISOLATED", str(kind == "function")).replace("WRAPPER", repr(str(wrapper)))
            (self.simulators / "helped.py").write_text(text)
            return "a", 0.0, 1.0
        if kind == "fmu":
            results = {"d": {"variable": "separation", "take": "minimum"}}
            described = {"name": "helped", "results": results, "parameters": {"mass": {}}, "slots": 2}
            binary = made.compiled(2, starts=str(wrapper))
            made.folder(self.simulators / "helped", 2, described=described, binary=binary)
            return "mass", 1.0, 10.0
        described = {
            "name": "helped",
            "parameters": {"a": {"nominal": 0.5, "low": 0, "high": 1}},
            "results": {"d": {"unit": "m"}},
            "slots": 2,
            "command": [str(wrapper), sys.executable, "-c", LINES],
        }
        if kind == "files":
            described |= {
                "protocol": "files",
                "command": [*described["command"][:3], FILES, "{parameters}", "{results}"],
            }
        (self.simulators / "helped").mkdir()
        (self.simulators / "helped" / "simulator.yaml").write_text(yaml.safe_dump(described))
        return "a", 0.0, 1.0


ENDINGS: dict[str, Callable[[Started, sa.Engine, int], None]] = {
    "cancel": lambda running, engine, run: cancel(engine, run),
    "SIGTERM": lambda running, engine, run: kill(running.pid, number=signal.SIGTERM),
    "child killed": lambda running, engine, run: kill(running.child()),
    "worker killed": lambda running, engine, run: kill(running.pid),
}


def cancel(engine: sa.Engine, run: int) -> None:
    with engine.begin() as connection:
        request_cancel(connection, run)


BY_DAY = {("lines", "worker killed")}


@pytest.mark.nightly  # by day a run of the command line
@pytest.mark.parametrize(
    ("kind", "ending"),
    [
        pytest.param(kind, ending, marks=[] if (kind, ending) in BY_DAY else [pytest.mark.nightly])
        for kind in KINDS
        for ending in ENDINGS
    ],
)
def test_a_run_of_a_worker(tmp_path: Path, kind: str, ending: str) -> None:
    with cluster(tmp_path, 1) if kind == "node" else nullcontext() as nodes:
        _nothing_is_left(Site(tmp_path, kind, nodes.address if nodes else ""), ending)


def _nothing_is_left(site: Site, ending: str) -> None:
    there = frozenset(helpers())
    engine, run = site.queued()
    url = engine.url.render_as_string(hide_password=False)
    with worker(url, site.folder, "first", "--lease", "2", **site.environment) as running:
        until(lambda: state(engine, run).evaluations > 20 and helpers(there), "under way, with helpers")
        begun = helpers(there)
        ENDINGS[ending](running, engine, run)
        if ending == "child killed":
            until(lambda: not begun & helpers(), "the helpers of the first child are gone")
            cancel(engine, run)
        until(lambda: ended(running, engine, run), "it ended")
        if ending != "worker killed":
            until(lambda: not helpers(there), "no helper is left", 1.3 * LOST + 10 if site.evaluator else 10)
            until(lambda: not site.folders(), f"no folder is left of {site.folders()}", 10)
    if ending == "worker killed":
        cancel(engine, run)
        with worker(url, site.folder, "second", **site.environment):
            until(lambda: not helpers(there), "no helper is left", 60)
            until(lambda: not site.folders(), f"no folder is left of {site.folders()}", 60)
    engine.dispose()


@pytest.mark.nightly
def test_a_node_that_is_killed(tmp_path: Path) -> None:
    """By its guards, as nothing of the node is left to end what its slots have started."""
    there = frozenset(helpers())
    with cluster(tmp_path, 1) as nodes:
        site = Site(tmp_path, "node", nodes.address)
        engine, run = site.queued()
        url = engine.url.render_as_string(hide_password=False)
        with worker(url, site.folder, "first", **site.environment):
            until(lambda: state(engine, run).evaluations > 20 and helpers(there), "under way, with helpers")
            kill(nodes.workers[0].pid)
            until(lambda: not helpers(there), "no helper is left", 10)
        engine.dispose()


@pytest.mark.nightly  # by day a worker that is killed
def test_a_child_that_is_ended_while_it_removes_its_folders(tmp_path: Path) -> None:
    """As at the end of a run: its slots have ended in order, so that no guard removes anything any more."""
    site = Site(tmp_path, "lines")
    engine, run = site.queued()
    url = engine.url.render_as_string(hide_password=False)
    with worker(url, site.folder, "first", "--lease", "2", **site.environment) as running:
        until(lambda: state(engine, run).evaluations > 20, "under way")
        (site.temporary / f"{PLACE}slots-left" / "0").mkdir(parents=True)
        kill(running.pid, number=signal.SIGTERM)
        until(lambda: running.process.poll() is not None, "it ended")
        assert site.folders() == []
    engine.dispose()


def ended(running: Started, engine: sa.Engine, run: int) -> bool:
    return running.process.poll() is not None or state(engine, run).state == "cancelled"


@pytest.mark.parametrize(
    ("kind", "number"),
    [
        ("lines", signal.SIGTERM),
        pytest.param("files", signal.SIGINT, marks=pytest.mark.nightly),
        pytest.param("function", signal.SIGKILL, marks=pytest.mark.nightly),
    ],
)
def test_a_run_of_the_command_line(tmp_path: Path, kind: str, number: signal.Signals) -> None:
    site = Site(tmp_path, kind)
    there = frozenset(helpers())
    campaign = site.folder / "campaign.yaml"
    campaign.write_text(yaml.safe_dump(site.document))
    command = [*CLEARANCE, "run", str(campaign)]
    with started(command, site.folder, "run", **site.environment) as running:
        until(lambda: helpers(there), "helpers run")
        kill(running.pid, number=number)
        until(lambda: running.process.poll() is not None, "it ended")
        until(lambda: not helpers(there), "no helper is left", 10)
        until(lambda: not site.folders(), f"no folder is left of {site.folders()}", 10)


@pytest.mark.parametrize("others", [0, 1], ids=["last slot", "another slot"])
@pytest.mark.parametrize("parent", ["ended", "another process"])
def test_a_guard_whose_parent_ended_before_it_began(tmp_path: Path, parent: str, others: int) -> None:
    """It starts nothing and removes the folder of its slot, with the last one that of all slots."""
    place = tmp_path / f"{PLACE}slots"
    own, started_file = place / "own", tmp_path / "started"
    for folder in (own, *(place / f"{k}" for k in range(others))):
        folder.mkdir(parents=True)
    with subprocess.Popen(["true"] if parent == "ended" else ["sleep", HELPERS]) as other:
        if parent == "ended":
            other.wait()
        words = [0, 1.0, 0.0, other.pid, -1, own, "touch", started_file]
        ended = subprocess.run([sys.executable, "-S", "-E", str(GUARD), *map(str, words)])
        other.kill()
    assert ended.returncode == 1
    assert not started_file.exists()
    assert place.exists() == bool(others)
    assert not own.exists()


def test_what_is_left_when_a_guard_is_killed(tmp_path: Path) -> None:
    """By its mark, where the pool still lives; else a worker that starts ends it."""
    there = frozenset(helpers())
    wrapper = tmp_path / "wrapper.sh"
    wrapper.write_text(WRAPPER.replace("env -i ", ""))
    wrapper.chmod(0o755)
    with SlotPool(Program([str(wrapper), sys.executable, "-c", LINES], "lines"), 1) as pool:
        assert pool.evaluate([{"parameters": {"a": 1.0}}])[0].kind == "ok"
        begun = helpers(there)
        assert len(begun) == 3
        kill(pool._slots[0].process.pid)
        assert pool.evaluate([{"parameters": {"a": 1.0}}])[0].kind in ("ok", "crash")
        until(lambda: not begun & helpers(), "its helpers are gone", 10)
    until(lambda: not helpers(there), "no helper is left", 10)
