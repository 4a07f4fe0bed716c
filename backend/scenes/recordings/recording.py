"""Records one flight, or case of a simulator, as a self-contained page: the scene of the 3D view over time.

The scene is drawn on a temporary viser server that accepts no clients. Recording time equals flight time, so the play
bar shows seconds of the flight.
"""

from __future__ import annotations

import secrets
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import viser

from backend.scenes.base.flight import Flight
from backend.scenes.base.palette import DARK, LIGHT, Palette
from backend.scenes.base.progress import Progress
from backend.scenes.base.setting import NOMINAL, Setting
from backend.scenes.control.relay import open_server
from backend.scenes.drawing.cameras import begin_at, pose
from backend.scenes.drawing.drawn import Drawn
from backend.scenes.drawing.flights import Flights
from backend.scenes.drawing.labels import Anchor, Label, Labels, Tag, View
from backend.scenes.drawing.solids import Solids
from backend.scenes.drawing.vectors import Vectors
from backend.scenes.drawing.world import World
from backend.scenes.panel.tables import number

RATE = 20.0
"""Frame rate [1/s of flight time]."""

MOST = 900
"""Maximum number of frames; longer flights have a lower frame rate."""


@dataclass(frozen=True)
class Cast:
    label: str
    shown: Flight
    nominal: Flight | None
    """None if the recorded flight is the nominal one, or the nominal one is not stored."""

    @property
    def flights(self) -> dict[str, Flight]:
        return ({NOMINAL: self.nominal} if self.nominal else {}) | {self.label: self.shown}


@dataclass(frozen=True)
class Recording:
    """A self-contained viser page, and the legend of its scene."""

    html: str
    statement: str


def record(setting: Setting, cast: Cast, dark: bool) -> Recording:
    """Record the flights with obstacles, rulers, velocities and separations from start to end."""
    server = open_server(secrets.token_urlsafe(32))
    try:
        stage = _Stage(server, setting, cast, DARK if dark else LIGHT)
        serializer = server.get_scene_serializer()
        end = max(0.0, *(float(one.time[-1]) for one in cast.flights.values()))
        times = np.linspace(0.0, end, int(np.clip(round(RATE * end), 2, MOST)) + 1)
        for before, time in pairwise(times):
            serializer.insert_sleep(float(time - before))
            stage.move(float(time))
        return Recording(serializer.as_html(dark_mode=dark), stage.statement)
    finally:
        server.stop()


class _Stage:
    def __init__(self, server: viser.ViserServer, setting: Setting, cast: Cast, palette: Palette) -> None:
        self._server, self._setting = server, setting
        stored = Progress(setting, 0, cast.label)
        stored.flights = cast.flights
        self._world = World(server, setting, palette)
        self._flights = Flights(server, setting, self._world, palette, stored)
        self._flights.chosen.restyle(0.0, title=cast.label)
        self._flights.stored()
        self._vectors = Vectors(server, setting, self._world, palette, self._flights)
        self._separation_tags = {
            drawn: self._separation_label(drawn) for drawn in self._flights.every if drawn.flight is not None
        }
        self._view = View(*pose("overview", self._world.whole, None))
        self._labels = Labels(self._tags, lambda: self._view)
        self.move(0.0)
        begin_at(server, (self._view.eye, self._view.target), self._world.frame.span)

    @property
    def statement(self) -> str:
        ahead = self._vectors.ahead
        arrows = f" The length of an arrow is the distance travelled in {ahead:g} s." if ahead else ""
        of = "flight time" if self._setting.clears else "the time of the trace"
        return f"The play bar shows {of} in seconds; dots every {self._flights.dots:g} s.{arrows}"

    def _separation_label(self, drawn: Drawn) -> Tag:
        anchor: Anchor = "bottom-center" if drawn.style.layer else "top-center"
        label = Label(f"/flights/{drawn.style.key}/now", drawn.style.title, np.zeros(3), anchor, 0.75)
        return Tag(label, Solids(self._server).label(label), np.zeros(3))

    def _tags(self, time: float) -> Iterator[Tag]:
        yield from self._flights.tags(time)
        yield from self._separation_tags.values()
        yield from (self._vectors.tag,) if self._vectors.tag is not None else ()
        yield from self._world.tags()

    def move(self, time: float) -> None:
        self._flights.moved(time)
        self._vectors.moved(time)
        for drawn, tag in list(self._separation_tags.items()):
            assert drawn.flight is not None
            position, _, separation = drawn.flight.at(time)
            ended = time > drawn.flight.time[-1] + 1e-9
            text = drawn.style.title + (": ended" if ended else self._now(separation))
            up = self._world.frame.unit * (1.1 if drawn.style.layer else -0.7)
            place = position + np.array([0.0, 0.0, up])
            tag.node.text = text
            self._separation_tags[drawn] = replace(tag, label=replace(tag.label, text=text, place=place))
        self._labels.moved(time)

    def _now(self, separation: float) -> str:
        """The separation in a label; of a simulator it is not known over time."""
        if not self._setting.clears:
            return ""
        return f": {number(separation, self._setting.decimals)} {self._setting.unit} now"
