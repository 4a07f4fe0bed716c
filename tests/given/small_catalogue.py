"""A small hand-written catalogue and campaign, to test the service without the physics."""

from __future__ import annotations

from typing import Any

from campaigns import Catalogue
from worker.running.catalogue import installed


def parameter(name: str, unit: str = "", low: float = -1e3, high: float = 1e3, default: float | None = 0.0) -> Any:
    """One entry of a component's parameters."""
    return {
        "name": name,
        "symbol": name,
        "unit": unit,
        "low": low,
        "high": high,
        "default": default,
        "text": name.capitalize(),
    }


def component(role: str, name: str, parameters: list[Any], **more: Any) -> dict[str, Any]:
    """One component."""
    base = {"role": role, "name": name, "title": name, "dimension": 2, "parameters": parameters, "text": ""}
    return {**base, **more}


def method(name: str, kind: str) -> dict[str, Any]:
    """One search method with one option."""
    options = {"type": "object", "properties": {"iterations": {"type": "integer", "minimum": 1}}}
    words = dict.fromkeys(("text", "how", "source"), "")
    return {
        "name": name,
        "title": name.upper(),
        "kind": kind,
        "evaluations": 100,
        "options": options,
        "starts": name == "sqp",
        **words,
    }


CATALOGUE = Catalogue.model_validate(
    {
        "version": "test",
        "components": [
            component(
                "vehicle",
                "unicycle",
                [parameter("m", "kg", 1e-3, 1e5, 5.0), parameter("J", "kg m2", 1e-6, 1e5, 0.05)],
                starts=[parameter(n) for n in ("x", "y", "theta", "v", "omega")],
            ),
            component(
                "controller",
                "pid_speed",
                [parameter(n) for n in ("k_p", "k_theta", "K_p1", "K_p2", "K_i1", "K_i2", "K_d1", "K_d2", "N")],
                fits=["unicycle"],
                demands=["force"],
            ),
            component(
                "avoider",
                "potential_field",
                [parameter(n) for n in ("k_att", "k_rep", "d_0")],
                demand="force",
                goals=[parameter("x", "m", default=None), parameter("y", "m", default=None)],
            ),
            component(
                "obstacle",
                "circle",
                [parameter("position.x", "m"), parameter("position.y", "m"), parameter("radius", "m", 0.0)],
            ),
            component("criterion", "separation", [], dimension=None, unit="m", quantity="d_min", worse="low"),
            component(
                "criterion",
                "goal_miss",
                [],
                dimension=None,
                title="Goal miss",
                unit="m",
                quantity="d_goal",
                worse="high",
                of="goal",
            ),
        ],
        "methods": [method("direct", "global"), method("sqp", "local"), method("monte_carlo", "random")],
    }
)


def published_by_workers() -> dict[str, Any]:
    """The catalogue of the installed components, as a worker publishes it."""
    return dict(installed.catalogue().model_dump(mode="json"))


def campaign(**changes: Any) -> dict[str, Any]:
    """A campaign that the catalogue can run; `changes` replace its top-level entries."""
    document: dict[str, Any] = {
        "name": "Unicycle past a pillar",
        "tags": ["case-1"],
        "scenario": {
            "vehicle": {"component": "unicycle", "parameters": {"m": 5.0}},
            "controller": {"component": "pid_speed"},
            "avoider": {"component": "potential_field"},
            "goal": {"x": 6, "y": 7},
            "obstacles": [{"component": "circle", "parameters": {"position": {"x": 4, "y": 4}, "radius": 0.5}}],
            "horizon": 15,
            "step": 0.005,
        },
        "uncertain": {"vehicle.m": {"plus_minus": "20%"}, "vehicle.J": {"low": 0.04, "high": 0.06}},
        "criterion": {"threshold": 0.5},
        "stages": {"search": [{"method": "direct", "evaluations": 1000}]},
    }
    return {**document, **changes}
