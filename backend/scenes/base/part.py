"""The interface between a viewer and the parts of its scene and panel.

A new tab or layer is a `Part` in its own file, added by `Panel`.
"""

from __future__ import annotations

from contextlib import AbstractContextManager
from typing import Protocol

from backend.scenes.base.palette import Palette


class Part:
    """Methods do nothing unless overridden. All but `stop` are called by one thread at a time, within one frame."""

    def moved(self, time: float) -> None:
        """The displayed time has changed [s]."""

    def changed(self) -> None:
        """Flights, findings, evaluations or the selection have changed."""

    def paint(self, palette: Palette) -> None:
        """The theme has changed."""

    def stop(self) -> None:
        """The visitor has disconnected: start no further work."""


class Driver(Protocol):
    """The viewer's interface for its parts, callable from any thread."""

    def drawing(self) -> AbstractContextManager[None]:
        """Group changes of scene and panel: exclusive, and shown in one frame."""

    def moved(self, time: float) -> None:
        """Update all parts to this time [s]."""

    def shown(self) -> None:
        """The visible layers of the flights have changed."""

    def changed(self) -> None:
        """Flights, findings, evaluations or the selection have changed."""

    def wake(self) -> None:
        """Wake the viewer's own thread."""
