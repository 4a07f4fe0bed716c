"""The flights of a scene (the nominal one, a finding, a what-if) and the obstacles."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import viser

from backend.scenes.base.axes import rotated
from backend.scenes.base.flight import Flight
from backend.scenes.base.palette import Palette
from backend.scenes.base.part import Part
from backend.scenes.base.progress import Progress
from backend.scenes.base.setting import NOMINAL, Setting
from backend.scenes.drawing import shapes
from backend.scenes.drawing.cameras import Sight
from backend.scenes.drawing.drawn import DOTS, Drawn, Style
from backend.scenes.drawing.labels import Tag
from backend.scenes.drawing.obstacles import Obstacles
from backend.scenes.drawing.world import World

WHAT_IF = "What-if"


class Flights(Part):
    def __init__(
        self, server: viser.ViserServer, setting: Setting, world: World, palette: Palette, progress: Progress
    ) -> None:
        self._setting, self._world, self._progress = setting, world, progress
        styles = (
            Style("nominal", "Nominal", palette.nominal, 0, "bottom"),
            Style("worst", called(progress.shown, setting), palette.worst, 1, "top"),
            Style("what-if", WHAT_IF, palette.what_if, 2, "beyond"),
        )
        self.nominal, self.chosen, self.what_if = (Drawn(server, setting, world, style) for style in styles)
        self.every = (self.nominal, self.chosen, self.what_if)
        self.obstacles = Obstacles(server, setting, palette, world)
        self.dots = shapes.even_step(setting.horizon, DOTS)
        """Time between the dots on a path [s]."""
        self.time = 0.0

    def stored(self) -> bool:
        """Draw the flights stored so far, and no longer those of before a reset; true if any has changed."""
        progress = self._progress
        wanted = {NOMINAL: self.nominal} | ({} if self.alone else {progress.shown: self.chosen})
        new = {
            drawn: flight
            for name, drawn in wanted.items()
            if (flight := progress.flights.get(name)) is not None and flight is not drawn.flight
        }
        gone = [drawn for name, drawn in wanted.items() if drawn.flight is not None and name not in progress.flights]
        for drawn in gone:
            drawn.clear()
        first = all(drawn.flight is None for drawn in self.every)
        if first and new:
            self._world.fit(list(new.values()))
        for drawn, flight in new.items():
            drawn.draw(flight, self.time)
        if new or gone or first:
            self.obstacles.update(self.every, self.time)
        return bool(new or gone)

    def choose(self) -> None:
        self.chosen.clear()
        self.chosen.restyle(self.time, title=called(self._progress.shown, self._setting))
        if not self.stored():
            self.obstacles.update(self.every, self.time)

    def show_what_if(self, flight: Flight | None) -> None:
        if flight is None:
            self.what_if.clear()
        else:
            title = f"{WHAT_IF}, other code" if self._setting.other_code(flight.identity) else WHAT_IF
            if title != self.what_if.style.title:
                self.what_if.restyle(self.time, title=title)
            self.what_if.draw(flight, self.time)
        self.obstacles.update(self.every, self.time)

    def trail(self, so_far: bool) -> None:
        """Draw the paths uniformly, or emphasise the part so far."""
        for drawn in self.every:
            drawn.trail.show(so_far, self.time, None if drawn.flight is None else drawn.place(self.time))

    def moved(self, time: float) -> None:
        self.time = time
        for drawn in self.every:
            drawn.move(time)
        self.obstacles.move(time)

    def paint(self, palette: Palette) -> None:
        colours = (palette.nominal, palette.worst, palette.what_if)
        for drawn, colour in zip(self.every, colours, strict=True):
            drawn.restyle(self.time, colour=colour)
        self.obstacles.paint(palette, self.time)

    def tags(self, time: float) -> Iterator[Tag]:
        """The visible labels at a time [s]: of closest approaches, then of obstacles."""
        yield from (drawn.tag for drawn in (self.chosen, self.what_if, self.nominal) if drawn.tag is not None)
        yield from self.obstacles.tags(time)

    @property
    def alone(self) -> bool:
        return self._progress.shown == NOMINAL

    @property
    def lead(self) -> Drawn | None:
        """The flight that cameras follow: the finding, else the nominal one; a visible one if there is any."""
        shown = [drawn for drawn in (self.chosen, self.nominal, self.what_if) if drawn.flight is not None]
        return next((drawn for drawn in shown if drawn.visible), shown[0] if shown else None)

    def sight(self, time: float) -> Sight | None:
        """The state of that flight at a time [s].

        The camera asks for it while another thread may draw another flight or none: each is read once.
        """
        lead = self.lead
        flight, bodies = (None, []) if lead is None else (lead.flight, lead.bodies)
        if lead is None or flight is None:
            return None
        turn, closest = flight.at(time)[1], flight.closest
        body = bodies[closest.number] if closest and closest.number < len(bodies) else None
        return Sight(
            vehicle=lead.place(time, flight),
            forward=rotated(turn, np.array([1.0, 0.0, 0.0])),
            obstacle=None if body is None else body.at(time),
            reach=0.0 if body is None else body.extent,
            closest=closest,
        )


def called(shown: str, setting: Setting) -> str:
    return "Worst" if shown == setting.worst else shown
