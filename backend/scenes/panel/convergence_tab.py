"""The tab with the convergence history of each search method."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import viser
from viser import uplot

from backend.results.improvements import Improvements
from backend.scenes.base.axes import Floats
from backend.scenes.base.palette import Palette
from backend.scenes.base.part import Part
from backend.scenes.base.setting import Setting

HAIR = 1e-4
"""A step that is invisible in a number with three decimals."""


def columns(curves: Sequence[Improvements]) -> tuple[Floats, ...]:
    """Evaluation numbers from 1, and each method's best so far as steps; NaN where it has no evaluations.

    Each improvement has two points, one just before it, so that the line is a step.
    """
    steps = {1.0 + index for curve in curves for index in curve.index}
    ends = {float(curve.read) for curve in curves if curve.read}
    grid = np.array(sorted(steps | {step - HAIR for step in steps if step > 1} | ends) or [1.0])
    return (grid, *(_best(curve, grid) for curve in curves))


def _best(curve: Improvements, grid: Floats) -> Floats:
    known = np.concatenate([[np.nan], curve.cost])
    count = np.searchsorted(1 + np.array(curve.index), grid, side="right")
    return np.where(grid <= curve.read, known[count], np.nan)


class ConvergenceTab(Part):
    def __init__(self, gui: viser.GuiApi, setting: Setting, palette: Palette, curves: dict[int, Improvements]) -> None:
        self._every = curves
        self._methods, self._looks = setting.methods, setting.drawn
        unit = f" [{setting.unit}]" if setting.unit else ""
        self._plot: Any = gui.add_uplot(
            columns(self._curves),
            self._series(palette),
            title=f"Best {setting.quantity} so far{unit}",
            scales={"x": uplot.Scale(time=False, distr=3), "y": uplot.Scale(auto=True)},
            axes=(uplot.Axis(label="Evaluations"), uplot.Axis(size=64)),
            aspect=1.15,
        )

    @property
    def _curves(self) -> list[Improvements]:
        return [self._every[position] for position, _, _ in self._methods]

    def changed(self) -> None:
        data = columns(self._curves)
        if any(not np.array_equal(new, old, equal_nan=True) for new, old in zip(data, self._plot.data, strict=True)):
            self._plot.data = data

    def paint(self, palette: Palette) -> None:
        self._plot.series = self._series(palette)

    def _series(self, palette: Palette) -> tuple[uplot.Series, ...]:
        lines = [
            uplot.Series(label=title, stroke=palette.method(self._looks.method(name)), width=2, points={"show": False})
            for _, name, title in self._methods
        ]
        return (uplot.Series(label="evaluation"), *lines)
