"""One thing in a viewer, in its scene or in its panel, as the viewer drives it. Start reading at `Part`.

A new tab or layer is a `Part` in a file of its own, added by `Panel`.
"""

from __future__ import annotations

from contextlib import AbstractContextManager
from typing import Protocol

from backend.scenes.base.address import Camera
from backend.scenes.base.palette import Palette


class Part:
    """What is not overridden does nothing. All but `stop` are called by one thread at a time, in one picture."""

    def moved(self, time: float) -> None:
        """Another time is shown [s]."""

    def changed(self) -> None:
        """Flights, findings or evaluations are others than before, or others are shown."""

    def paint(self, palette: Palette) -> None:
        """The theme is another one now."""

    def stop(self) -> None:
        """The visitor is gone: begin nothing more."""


class Driver(Protocol):
    """The viewer as its parts ask things of it, from any thread."""

    def drawing(self) -> AbstractContextManager[None]:
        """One change of scene and panel: nobody else changes them meanwhile, and it is seen at once."""

    def moved(self, time: float) -> None:
        """Show everything at this time [s]."""

    def look_from(self, camera: Camera | None) -> None:
        """Look from there; from None: stay, and follow nothing."""

    def shown(self) -> None:
        """What is to be seen of the flights has changed."""

    def changed(self) -> None:
        """Flights, findings or evaluations are others than before, or others are shown."""

    def wake(self) -> None:
        """There is something to do for the viewer's own thread."""
