"""What the README shows works: the campaign can be run, the component flies."""

from __future__ import annotations

import re
import sys
import types
from pathlib import Path

import numpy as np
import pytest

from campaigns import check
from campaigns.asked.load import load_text
from worker.catalogue.installed import catalogue, components
from worker.kernels.component import Obstacle, declared
from worker.kernels.layout import Parts
from worker.systems.closed_loop.assemble import Loop
from worker.systems.problem import Problem

README = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")


def block(language: str) -> str:
    """The README's one fenced block in that language."""
    blocks = re.findall(rf"^```{language}\n(.*?)^```$", README, re.MULTILINE | re.DOTALL)
    assert len(blocks) == 1
    return str(blocks[0])


def test_the_campaign_can_be_run() -> None:
    campaign = load_text(block("yaml"), "README")
    assert check(campaign, catalogue()) == []
    problem = Problem(campaign)
    corners = np.zeros(problem.dimension), np.ones(problem.dimension)
    batch, reasons = problem.fly(np.array([problem.nominal_point, *corners]))
    assert reasons == {}
    assert (batch.costs[:, 0] > 0.5).all()
    assert batch.costs.shape == (3, 3)


def test_the_component_flies(monkeypatch: pytest.MonkeyPatch) -> None:
    module = types.ModuleType("post")
    monkeypatch.setitem(sys.modules, "post", module)
    exec(compile(block("python"), "post.py", "exec", dont_inherit=True), module.__dict__)
    post: Obstacle = module.component
    assert [p.name for p in declared(post.parameters)] == ["x", "y"]
    known = components()
    parts = Parts(
        known["vehicle", "unicycle"],  # type: ignore[arg-type]
        known["controller", "pid_speed"],  # type: ignore[arg-type]
        known["avoider", "potential_field"],  # type: ignore[arg-type]
        (post,),
        known["criterion", "separation"],  # type: ignore[arg-type]
    )
    loop = Loop(parts, compiled=False)
    given = {"goal.x": 6.0, "goal.y": 7.0, "criterion.threshold": 0.5, "obstacles.0.x": 4.0, "obstacles.0.y": 4.0}
    vector = np.array(
        [given.get(f"{s.prefix}.{p.name}", p.default) for s in loop.sections for p in s.parameters], dtype=np.float64
    )
    flown = loop.fly(vector[None], 0.005, 1000)
    assert flown.status[0] == 0.0
    assert 0.3 < flown.costs[0, 0] < 1.5
