"""The tab with the best so far of each search method over its evaluations. Start reading at `columns`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray
from viser import uplot

from backend.results.improvements import Improvements
from backend.scenes.palette import Palette
from backend.scenes.setting import Setting

Floats = NDArray[np.float64]

HAIR = 1e-4
"""Too little to be seen in a number with three decimals."""


def columns(curves: Sequence[Improvements]) -> tuple[Floats, ...]:
    """Evaluation numbers from 1, and each method's best so far at them, as steps; NaN where it has not flown.

    A step is drawn as one: every number at which something improves is there together with one a hair before it.
    """
    steps = {1.0 + index for curve in curves for index in curve.index}
    ends = {float(curve.read) for curve in curves if curve.read}
    grid = np.array(sorted(steps | {step - HAIR for step in steps if step > 1} | ends) or [1.0])
    return (grid, *(_best(curve, grid) for curve in curves))


def _best(curve: Improvements, grid: Floats) -> Floats:
    known = np.concatenate([[np.nan], curve.cost])
    count = np.searchsorted(1 + np.array(curve.index), grid, side="right")
    return np.where(grid <= curve.read, known[count], np.nan)


class ConvergenceTab:
    """One plot, drawn again while the search goes on."""

    def __init__(self, gui: viser.GuiApi, setting: Setting, palette: Palette, curves: dict[int, Improvements]) -> None:
        self._curves = [curves[position] for position, _, _ in setting.methods]
        described = [(title, palette.method(name)) for _, name, title in setting.methods]
        series = [uplot.Series(label="evaluation")]
        series += [
            uplot.Series(label=title, stroke=colour, width=2, points={"show": False}) for title, colour in described
        ]
        unit = f" [{setting.unit}]" if setting.unit else ""
        self._plot: Any = gui.add_uplot(
            columns(self._curves),
            tuple(series),
            title=f"Best {setting.quantity} so far{unit}",
            scales={"x": uplot.Scale(time=False, distr=3), "y": uplot.Scale(auto=True)},
            axes=(uplot.Axis(label="Evaluations"), uplot.Axis(size=64)),
            aspect=1.15,
        )

    def refresh(self) -> None:
        """Bring the plot up to date."""
        self._plot.data = columns(self._curves)
