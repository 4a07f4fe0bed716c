"""Compares the distance that a criterion of obstacles declares with what it computes, in a small closed loop."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from campaigns.checked.distances import WHAT_TO_DO
from worker.engine.kernels.component import Criterion
from worker.engine.systems.closed_loop.assemble import Loop
from worker.engine.systems.closed_loop.distances import Instant, compared
from worker.running.examination.scenes import Own, nominal, scenes

APART = 50.0
"""How far the second obstacle is from the first one along every axis [m]."""


def note_of(criterion: Criterion, own: Own) -> str:
    """Why no run with it is cleared, as a clause; empty if it computes what it declares, or declares no distance."""
    if criterion.of != "obstacles" or criterion.measured_to not in ("centre", "surface"):
        return ""
    declared = f'it declares measured_to="{criterion.measured_to}"'
    if criterion.unit != "m":
        unit = f"in {criterion.unit}" if criterion.unit else "without a unit"
        return f"{declared}, but its value is {unit}, not in m, so no run with it is cleared: {WHAT_TO_DO}"
    for scene in scenes(criterion, own):
        parts = replace(scene, obstacles=scene.obstacles * 2)
        loop = Loop(parts, lanes=1, compiled=False)
        row = np.array(nominal(parts, loop.sections))
        for section in (s for s in loop.sections if s.prefix == "obstacles.1"):
            for k, parameter in enumerate(section.parameters):
                row[section.first + k] += APART * parameter.name.startswith("position.")
        state = loop.part("initial")(loop.extend(row))
        with np.errstate(all="ignore"):
            found = compared(loop, parts, [Instant(row, 0.0, np.array(state, dtype=float)[: loop.n_state])])
        if found is not None:
            has = "no value" if found.value is None else f"the value {found.value:.4g} m"
            return (
                f"{declared}, but where that distance is {found.distance:.4g} m, it has {has}, so no run with it is "
                f"cleared: {WHAT_TO_DO}"
            )
    return ""
