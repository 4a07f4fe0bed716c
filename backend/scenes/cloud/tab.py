"""The tab of the parameter space: axes, legend, and the clicked evaluation.

That of a scenario is simulated again; of a simulator's only what is stored is shown, since a call may take long.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
import sqlalchemy as sa
import viser

from backend.db.engine import read
from backend.runs.service import number, summary
from backend.scenes.base.address import Camera
from backend.scenes.base.flight import ROWS, Flight, from_live
from backend.scenes.base.noise import STATED
from backend.scenes.base.palette import DARK, Palette
from backend.scenes.base.part import Driver, Part
from backend.scenes.base.progress import Progress
from backend.scenes.base.schemas import NONE as NO_AXIS
from backend.scenes.base.schemas import VALUE
from backend.scenes.base.setting import NOMINAL, Setting, UnknownParameterError
from backend.scenes.cloud import words
from backend.scenes.cloud.drawn import CloudDrawn
from backend.scenes.cloud.evaluations import Axes, Axis, Cloud, Evaluation, axes, load, met
from backend.scenes.drawing.cameras import Pose, distance
from backend.scenes.drawing.following import Following
from backend.scenes.drawing.world import World
from backend.scenes.live.latest import Latest
from backend.scenes.live.live import Live, LiveError
from backend.scenes.panel import tables

NOTHING = "–"
"""No axis."""
PATIENCE = 5.0
"""Minimum interval between reads of the evaluations of an active run [s]."""
TOWARDS = (0.55, -0.75, 0.38)
"""Direction from the box to the camera."""


Take = Callable[[Flight, int | None], None]
"""Callback that draws a flight as the what-if, with its noise seed; None for those of the campaign."""


class CloudTab(Part):
    """Reads the stored evaluations when first shown; simulates the newest click and drops superseded ones."""

    def __init__(
        self,
        server: viser.ViserServer,
        engine: sa.Engine,
        live: Live,
        setting: Setting,
        world: World,
        progress: Progress,
        following: Following,
        driver: Driver,
        take: Take,
    ) -> None:
        self._server, self._engine, self._live, self._setting = server, engine, live, setting
        self._world, self._progress, self._following = world, progress, following
        self._driver, self._take = driver, take
        self._drawn = CloudDrawn(server, setting, world, world.palette)
        self._cloud: Cloud | None = None
        self._read, self._whole = 0.0, False
        """Time of the last read [s], and whether the run had ended then."""
        self._visible = self._stopped = False
        self._picked: Evaluation | None = None
        self._along: Axes = (None, None, None)
        self._before: Camera | None = None
        self._own: Pose | None = None
        """The last camera of the flights: named, or the visitor's own."""
        self._panel(server.gui)
        self._loads: Latest[None] = Latest(lambda _: self._load())
        self._flies: Latest[Evaluation] = Latest(self._fly)

    def _panel(self, gui: viser.GuiApi) -> None:
        titles = [f"{one.path} [{one.unit}]" if one.unit else one.path for one in self._setting.uncertain]
        value = Axis(self._setting.quantity or "value", self._setting.unit, 0.0, 0.0).title
        paths = [one.path for one in self._setting.uncertain]
        self._paths = {**dict(zip(titles, paths, strict=True)), value: VALUE, NOTHING: NO_AXIS}
        first = [*titles[:3], value][:3] if len(titles) > 1 else [*(titles or [NOTHING]), NOTHING, value]
        options = (*titles, value, NOTHING)
        self._axes: list[Any] = [
            gui.add_dropdown(f"Axis {name}", options, initial_value=title)
            for name, title in zip("xyz", first, strict=True)
        ]
        every = f"Every stored evaluation is a point. {words.hint(self._setting)}"
        self._legend: Any = gui.add_html(tables.note(every))
        self._result: Any = gui.add_html("")
        self._go: Any = None
        """The button of the simulated flight; None of a simulator."""
        if self._setting.clears:
            self._go = gui.add_button("Show its flight", disabled=True, hint="The flight of the clicked point.")
            self._go.on_click(lambda _: self.show(False))
        for one in self._axes:
            one.on_update(lambda _: self._redraw())

    def show(self, visible: bool) -> None:
        """Switch between parameter space and flights, including the camera."""
        with self._driver.drawing():
            if visible == self._visible:
                return
            self._visible = visible
            self._world.show(not visible)
            self._drawn.show(visible)
        scene = self._server.scene
        if visible:
            self._before = self._following.camera
            self._own = self._following.eye
            scene.on_click()(self._clicked)
            self._driver.look_from(None)
            self._look()
            if not self._whole:
                self._loads.ask(None)
        else:
            scene.remove_click_callback(self._clicked)
            self._driver.look_from(self._before)
            if self._before is None and self._own is not None:
                self._following.place(self._own)

    @property
    def on(self) -> bool:
        """Whether the parameter space is visible."""
        return self._visible

    @property
    def along(self) -> tuple[str, str, str]:
        """The paths of the parameters along x, y and z, `value` or `none`."""
        x, y, z = (self._paths[one.value] for one in self._axes)
        return x, y, z

    def have(self, on: bool | None, along: tuple[str, str, str] | None) -> None:
        """Change visibility and axes; None leaves them unchanged. Raises `UnknownParameterError`."""
        titles = {path: title for title, path in self._paths.items()}
        if along is not None:
            unknown = next((path for path in along if path not in titles), None)
            if unknown is not None:
                raise UnknownParameterError(f"{unknown!r} is not an axis of this parameter space: {', '.join(titles)}")
            for axis, path in zip(self._axes, along, strict=True):
                axis.value = titles[path]
        if on is not None:
            self.show(on)

    def changed(self) -> None:
        """Read the evaluations again if they are visible and may have changed."""
        due = self._progress.over or time.monotonic() - self._read > PATIENCE
        if self._visible and due and not self._whole:
            self._loads.ask(None)

    def paint(self, palette: Palette) -> None:
        """Draw the tab in other colours."""
        self._drawn.palette = palette
        self._redraw()

    def stop(self) -> None:
        """Stop reading, simulating and drawing."""
        self._loads.stop()
        self._flies.stop()
        with self._driver.drawing():
            self._stopped = True

    def _look(self) -> None:
        """Move the camera to a view of the whole box."""
        direction = np.array(TOWARDS) / np.linalg.norm(TOWARDS)
        half = 0.62 * self._drawn.side
        corners = np.array([(x, y, z) for x in (-half, half) for y in (-half, half) for z in (-half, half)])
        middle = self._world.frame.middle
        eye = middle + distance(corners, direction) * direction
        self._following.place((eye, middle))

    def _load(self) -> None:
        flight, over, run_id = self._progress.flights.get(NOMINAL), self._progress.over, number(self._setting.run)
        nominal = flight.cost if flight else None
        with read(self._engine) as reader:
            if not self._setting.clears:  # its trace may show one more call, with another value
                nominal = summary(reader, run_id).nominal_cost
            cloud = load(reader, run_id, self._setting, nominal)
        self._cloud, self._read, self._whole = cloud, time.monotonic(), over
        self._redraw()

    def _redraw(self) -> None:
        with self._driver.drawing():
            if self._cloud is None or self._stopped:
                return
            known = axes(self._setting, self._cloud)
            self._along = [known.get(one.value) for one in self._axes]
            self._drawn.draw(self._cloud, self._along)
            if self._picked is not None:
                self._drawn.pick(self._picked, self._along)
            self._legend.content = words.legend(self._cloud, self._setting, self._drawn.palette is DARK)

    def _clicked(self, event: Any) -> None:
        with self._driver.drawing():
            cloud = self._cloud
            if cloud is None:
                return
            found = met(self._drawn.points, event.ray_origin, event.ray_direction)
            if found is None:
                self._result.content = tables.note("There is no evaluation near that position.")
                return
            one = self._picked = cloud.drawn[found]
            self._drawn.pick(one, self._along)
            if not self._setting.clears:
                self._result.content = words.stored(one, self._setting)
                return
            self._result.content = words.simulating(one)
            self._go.disabled = True
        self._flies.ask(one)

    def _fly(self, one: Evaluation) -> None:
        """Simulate it with the bit-identical stored parameters, and compare with the stored result."""
        try:
            answer = self._live.simulate(self._setting.document, self._setting.digest, one.parameters, ROWS, one.noise)
        except LiveError as error:
            self._say(words.simulating(one) + tables.note(str(error), strong=True), None, one)
            return
        self._say(words.outcome(one, answer, self._setting), from_live(answer), one)

    def _say(self, result: str, flight: Flight | None, one: Evaluation) -> None:
        with self._driver.drawing():
            if self._stopped:
                return
            if flight is not None:
                self._take(flight, None if one.noise == STATED else flight.seed)
            self._result.content = result
            self._go.disabled = flight is None
