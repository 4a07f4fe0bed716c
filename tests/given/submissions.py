"""Submits runs for tests."""

from __future__ import annotations

import json
from typing import Any

import httpx

from tests.given.small_catalogue import campaign

YAML = {"content-type": "application/yaml"}


def submit(client: httpx.Client, **changes: Any) -> str:
    """Submit a campaign; returns the run's id."""
    answer = client.post("/api/v1/runs", json={"campaign": campaign(**changes)})
    assert answer.status_code == 201, answer.text
    return str(answer.json()["id"])


def swept(client: httpx.Client, values: list[float], **more: Any) -> dict[str, Any]:
    """Launch a sweep over the avoider's distance; returns it."""
    given = {"campaign": campaign(), "path": "avoider.d_0", "values": values, "name": "Range", **more}
    answer = client.post("/api/v1/sweeps", json=given)
    assert answer.status_code == 201, answer.text
    return dict(answer.json())


def altered(*path: str | int, value: Any) -> dict[str, Any]:
    """The campaign with the entry at that path replaced."""
    document: Any = json.loads(json.dumps(campaign()))
    place = document
    for step in path[:-1]:
        place = place[step] if isinstance(place, list) else place.setdefault(step, {})
    place[path[-1]] = value
    return dict(document)


WRONG: dict[str, tuple[dict[str, Any], str, str]] = {
    "unknown component": (
        altered("scenario", "vehicle", "component", value="unicylce"),
        "scenario.vehicle.component",
        "did you mean 'unicycle'?",
    ),
    "unknown key": (altered("scenario", "speeed", value=1), "scenario.speeed", "unknown key"),
    "unknown parameter": (
        altered("scenario", "vehicle", "parameters", "mass", value=1.0),
        "scenario.vehicle.parameters.mass",
        "no such parameter",
    ),
    "value outside limits": (
        altered("scenario", "vehicle", "parameters", "m", value=-1.0),
        "scenario.vehicle.parameters.m",
        "must be within 0.001 to 100000 kg",
    ),
    "bound outside limits": (
        altered("uncertain", "vehicle.J", value={"low": -0.04, "high": 0.06}),
        "uncertain.vehicle.J.low",
        "must be within",
    ),
    "reversed interval": (
        altered("uncertain", "vehicle.J", value={"low": 0.06, "high": 0.04}),
        "uncertain.vehicle.J",
        "reversed",
    ),
    "wrong unit": (
        altered("uncertain", "vehicle.m", value={"plus_minus": "20%", "unit": "g"}),
        "uncertain.vehicle.m.unit",
        "is kg",
    ),
    "unknown method": (altered("stages", "search", 0, "method", value="magic"), "stages.search.0.method", "no such"),
    "absurd size": (altered("scenario", "step", value=1e-9), "scenario", "steps"),
    "missing scenario": ({"name": "x"}, "scenario", "required"),
}
