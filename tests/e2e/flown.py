"""Runs of every kind that a worker evaluated, made once and copied for each file of tests."""

from __future__ import annotations

import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import sqlalchemy as sa

from backend.db import workers
from backend.db.engine import read
from backend.db.tables import Run, Worker
from campaigns import library, load_file
from tests.e2e.stored import opened
from tests.faults.processes import CLEARANCE, started, until
from tests.given.heartbeats import beating
from tests.given.service import Service
from tests.migrated import migrated
from tests.simulators import dropped, package

FEW = {"at_most": 2, "evaluations": 100}
"""Findings: to distinguish all minima of a case takes thousands of evaluations."""
QUICK = {
    "sensitivity": {"points": 3},
    "search": [{"method": name, "evaluations": 40} for name in ("direct", "sqp", "monte_carlo")],
    "findings": FEW | {"at_most": 1},
    "validate": {"neighbours": 5, "evaluations": 20_000},
}
FULL = {
    "sensitivity": {"points": 3, "sobol": {"samples": 8}},
    "search": [
        {"method": "direct", "evaluations": 100},
        {"method": "sqp", "evaluations": 60},
        {"method": "monte_carlo", "evaluations": 60},
    ],
    "certify": {"samples": 100},
    "findings": FEW,
    "validate": {"neighbours": 5, "evaluations": 20_000},
}
BOX, AGAIN, INTRUDER, CANCELLED, BASINS, CLEARED, SEVERAL, DROP, DRAWN = (f"R-{i:04}" for i in range(1, 10))
"""Case 1; a simulator without a trace; an intruder; a cancelled run; the simulator, violated and cleared; case 1 with
several criteria; a simulator with a trace; and one with a 3D view, too."""
CRITERIA = [
    {"component": "goal_miss"},
    {"component": "time_to_goal", "parameters": {"radius": 0.5}},
    {"component": "peak_command"},
]
OPEN = {"queued", "running", "cancelling"}


@dataclass(frozen=True)
class Flown:
    """The folder of the data, and that of the simulators with a trace, which is empty without a C compiler."""

    data: Path
    simulators: Path


def asked() -> list[dict[str, Any]]:
    """The runs in their order, as they are submitted."""
    long = "with a name that is too long for its place"
    nsga2 = QUICK | {"search": [{"method": "nsga2", "evaluations": 100}]}
    several = case("unicycle_static", nsga2) | {"objectives": CRITERIA}
    return [
        {"campaign": case("unicycle_static", QUICK), "name": "Full box", "tags": ["release-2.4", "baseline"]},
        {"campaign": package.campaign(), "name": "Once more", "tags": ["baseline"]},
        {"campaign": case("uav_moving", FULL), "name": f"Intruder, {long}", "tags": ["a-long-tag", "b"]},
        {"campaign": case("unicycle_static", QUICK), "name": "Cancelled"},
        {"campaign": package.campaign(), "name": "Basins"},
        {"campaign": package.campaign(1.0), "name": "Basins, another threshold"},
        {
            "campaign": several,
            "name": "Several criteria",
        },  # a loop that tests/unit/engine/stages/test_front.py compiles
        *(dropping() if dropped.compiler() else []),
    ]


def dropping() -> list[dict[str, Any]]:
    """Runs of the simulators with a trace. Few evaluations: each is repeated in a process of its own."""
    stages = dropped.campaign()["stages"]
    methods = [{"method": name, "evaluations": 10} for name in ("direct", "differential_evolution")]
    small = stages | {"search": methods, "certify": {"samples": 5}, "validate": {"neighbours": 2, "evaluations": 40}}
    few = {"stages": small, "uncertain": {"simulator.wind": {"low": -1.0, "high": 2.0}}}
    clear = {"criterion": {"result": "separation", "threshold": 1e-9}}  # no violation is repeated
    return [
        {"campaign": dropped.campaign(**few), "name": "Drop"},
        {"campaign": dropped.campaign(**few, **clear, simulator={"name": dropped.DRAWN}), "name": "Drop in 3D"},
    ]


def case(name: str, stages: dict[str, Any]) -> dict[str, Any]:
    """A shipped case with other stages."""
    return load_file(library()[name]).document() | {"stages": stages}


def fly(folder: Path) -> Flown:
    """Have a worker evaluate the runs, submitted to a service."""
    found = Flown(folder / "data", folder / "simulators")
    found.simulators.mkdir()
    if dropped.compiler():
        dropped.install(found.simulators)
        dropped.install(found.simulators, scene=True)
    environment = {
        "CLEARANCE_DATABASE": migrated(found.data),
        "CLEARANCE_SIMULATORS": str(found.simulators),
        "PYTHONPATH": package.path(package.install(folder / "package")),
    }
    command = [*CLEARANCE, "worker", "--name", "w1"]
    known = 1 + len(list(found.simulators.iterdir()))
    with (
        started(command, folder, "worker", **environment) as worker,
        opened(found.data) as service,
        service.signed_in() as client,
    ):

        def ended() -> bool:
            return worker.process.poll() is not None

        until(lambda: len(simulators(service)) == known or ended(), "a worker", 120)
        assert not ended(), worker.text()
        runs = [submit(client, body) for body in asked()]
        assert client.post(f"/api/v1/runs/{CANCELLED}/cancel").is_success
        until(lambda: OPEN.isdisjoint(states(service).values()) or ended(), "all over", 280)
        assert states(service) == dict.fromkeys(runs, "done") | {CANCELLED: "cancelled"}, worker.text()
    return found


def submit(client: httpx.Client, body: dict[str, Any]) -> str:
    """Submit a run; returns its name."""
    answer = client.post("/api/v1/runs", json=body)
    assert answer.status_code == 201, answer.text
    return str(answer.json()["id"])


def states(service: Service) -> dict[str, str]:
    """The state of every run."""
    with read(service.engine) as connection:
        return {f"R-{number:04}": state for number, state in connection.execute(sa.select(Run.id, Run.state))}


def simulators(service: Service) -> list[Any]:
    """The simulators of live workers."""
    with read(service.engine) as connection:
        return list(workers.simulators(connection))


@contextmanager
def copied(flown: Flown, folder: Path) -> Iterator[Service]:
    """A running service on a copy of the runs; the worker that is stored in it stays alive."""
    data = shutil.copytree(flown.data, folder / "data")
    with opened(data) as service:
        with service.engine.begin() as connection:
            connection.execute(sa.update(Worker).values(beat=time.time(), run_id=None))
        with beating(service.engine):
            yield service
