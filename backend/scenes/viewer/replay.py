"""The time and speed of a viewer's replay, and the visible layers of the flights; controlled by the page."""

from __future__ import annotations

from typing import Any

from backend.scenes.base.part import Driver
from backend.scenes.base.schemas import LayersChange, Trails, ViewChange
from backend.scenes.base.setting import Setting
from backend.scenes.drawing.flights import Flights
from backend.scenes.drawing.vectors import Vectors

STEP = 0.01
"""Times closer than this are considered equal [s]."""


class Replay:
    def __init__(self, setting: Setting, flights: Flights, vectors: Vectors, driver: Driver) -> None:
        self._horizon, self._flights, self._vectors, self._driver = setting.horizon, flights, vectors, driver
        self.time, self.speed, self.playing = 0.0, 1.0, False
        self.trail: Trails = "whole"
        self._roles = {"nominal": flights.nominal, "finding": flights.chosen, "what_if": flights.what_if}

    @property
    def layers(self) -> dict[str, Any]:
        shown = {name: drawn.visible for name, drawn in self._roles.items()}
        arrows = {"velocity": self._vectors.velocity, "relative": self._vectors.relative}
        return {**shown, **arrows, "trail": self.trail}

    @property
    def shown(self) -> dict[str, Any]:
        """Time and playback as fields of `ViewState`."""
        return {"time": self.time, "horizon": self._horizon, "playing": self.playing, "speed": self.speed}

    def steer(self, change: ViewChange) -> None:
        """Change time or speed. Setting a time pauses playback unless the same change requests to play."""
        self.speed = self.speed if change.speed is None else change.speed
        if change.closest:
            self.go_to_closest()
        if (change.time is not None or change.step is not None) and not (change.passing and self.playing):
            self.play(False)
            self.go_to((self.time if change.time is None else change.time) + (change.step or 0.0))
        if change.playing is not None:
            self.play(change.playing)

    def have(self, layers: LayersChange) -> None:
        """Change the visible layers; None leaves a layer unchanged."""
        for name, drawn in self._roles.items():
            wanted = getattr(layers, name)
            if wanted is not None and wanted != drawn.visible:
                drawn.show(wanted)
                self._driver.shown()
        velocity = self._vectors.velocity if layers.velocity is None else layers.velocity
        relative = self._vectors.relative if layers.relative is None else layers.relative
        if (velocity, relative) != (self._vectors.velocity, self._vectors.relative):
            self._vectors.show(velocity, relative)
        if layers.trail is not None and layers.trail != self.trail:
            self.trail = layers.trail
            self._flights.trail(self.trail == "so_far")

    def play(self, on: bool) -> None:
        self.playing = on
        self._driver.wake()

    def advance(self, seconds: float) -> None:
        """Advance the time; wraps from the end to the start."""
        self.go_to((self.time + seconds * self.speed) % self._horizon)

    def go_to(self, time: float) -> None:
        """Show this time, clipped to start and horizon."""
        with self._driver.drawing():
            self.time = min(max(time, 0.0), self._horizon)
            self._driver.moved(self.time)

    def go_to_closest(self) -> None:
        """Show the closest approach of the worst flight, paused."""
        time = self.closest_time()
        if time is not None:
            self.play(False)
            self.go_to(time)

    def closest_time(self) -> float | None:
        flights = [one.flight for one in self._flights.every if one.flight is not None and one.flight.closest]
        worst = min(flights, key=lambda flight: flight.closest.value if flight.closest else 0.0, default=None)
        return None if worst is None or worst.closest is None else worst.closest.time
