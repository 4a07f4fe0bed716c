"""A run of a simulator whose traces declare what they are positions of."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import httpx
import numpy as np

from campaigns.catalogue import ParameterEntry, ResultEntry, SimulatorEntry
from campaigns.stored.records import Columns, StagePlan, Trace
from tests import results
from tests.given.finished_runs import PLAN, Work, search
from tests.given.service import Service
from tests.given.small_catalogue import CATALOGUE

ENTRY = SimulatorEntry(
    name="drop",
    title="Parachute drop",
    text="A load falls.",
    parameters=[ParameterEntry(name="wind", symbol="w", unit="m/s", low=-5.0, high=5.0, default=1.0, text="Wind")],
    results=[ResultEntry(name="separation", title="Separation", quantity="d_min", unit="m", worse="low")],
)
CAMPAIGN = {
    "name": "Drop",
    "simulator": {"name": "drop"},
    "uncertain": {"simulator.wind": {"low": 0.0, "high": 4.0}},
    "criterion": {"result": "separation", "threshold": 1.0},
    "stages": {"search": [{"method": "direct", "evaluations": 1000}]},
}
SCENE: dict[str, Any] = {
    "frame": "z_up",
    "vehicle": {"position": ["x", 0, "z"]},
    "bodies": [{"name": "bird", "position": ["bird", 5, 20], "radius": 0.5}],
    "obstacles": [{"name": "mast", "shape": "cylinder", "position": [12, 0, 15], "radius": 0.4, "height": 30}],
}


def trace(name: str, scene: dict[str, Any] | None = SCENE, speed: float = 1.0, **changed: Any) -> Trace:
    """A load that falls from 100 m within 20 s and drifts at `speed` [m/s], past a bird that is at x = -t.

    changed: columns with other values, by name.
    """
    t = np.linspace(0.0, 20.0, 401)
    half = np.full(401, np.sqrt(0.5))
    values = {"x": speed * t, "z": 100.0 - 5.0 * t, "bird": -t, "deg": 90.0 + 0 * t, "q": half} | changed
    units = {"deg": "deg", "q": ""}
    columns = [("time", "s", "time"), *((n, units.get(n, "m"), "signal") for n in values)]
    head = {"parameters": {"simulator.wind": speed}, "cost": 2.0, "values": {"separation": 2.0}, "scene": scene}
    data = np.column_stack([t, *values.values()])
    return Trace(name, results.columns(*columns), data, results.head(**head))


def declared(
    service: Service,
    client: httpx.Client,
    traces: Callable[[str], Trace] = trace,
    found: bool = True,
    searched: Columns | None = None,
    plan: Sequence[StagePlan] = PLAN,
) -> str:
    """A finished run with the traces of the nominal case and of one finding; searched: its evaluations; plan: its
    stages, of which the third one is the search."""
    catalogue = CATALOGUE.model_copy(update={"simulators": [ENTRY]})
    service.publish(catalogue.model_dump(mode="json"))
    asked = {"stages": {"search": [{"method": plan[2].method, "evaluations": 1000}]}}
    answer = client.post("/api/v1/runs", json={"campaign": CAMPAIGN | asked})
    assert answer.status_code == 201, answer.text
    work = Work(service, plan, [ENTRY.version])
    work.nominal(traces("nominal"))
    if found:
        work.store.begin(2)
        work.store.append(2, 0, searched or search(0, 10))
        work.found(flown=traces("F1"))
    work.conclude()
    return str(answer.json()["id"])
