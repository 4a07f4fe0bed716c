"""The tab that replays the flights: which, time, play, cameras, what to show, readouts. Read `FlightTab`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, cast

import viser

from backend.scenes import tables
from backend.scenes.address import CAMERAS, Camera
from backend.scenes.drawn import Drawn
from backend.scenes.flights import Flights
from backend.scenes.part import Driver, Part
from backend.scenes.setting import NOMINAL, Setting
from backend.scenes.vectors import Vectors

SPEEDS = {"0.25×": 0.25, "0.5×": 0.5, "1×": 1.0, "2×": 2.0, "5×": 5.0}
STEP = 0.01
"""Of the time slider [s]."""
OWN = "Own"
"""The camera that the visitor has moved."""
ALONE = "Nominal alone"
TRAILS = ("Whole", "So far")


class FlightTab(Part):
    """Holds the time shown; the driver is told of every new one."""

    def __init__(
        self,
        gui: viser.GuiApi,
        setting: Setting,
        flights: Flights,
        vectors: Vectors,
        driver: Driver,
        time: float,
        camera: Camera,
        shown: str,
    ) -> None:
        self._setting, self._flights, self._vectors, self._driver = setting, flights, vectors, driver
        self.time = self._held(time)
        self._finding: Any = gui.add_dropdown(
            "Finding", (_title(shown),), hint="The finding that is shown beside the nominal flight."
        )
        self._slider: Any = gui.add_slider("Time [s]", 0.0, setting.horizon, STEP, round(self.time, 2))
        self._play: Any = gui.add_checkbox("Play", False)
        self._speed: Any = gui.add_dropdown("Speed", tuple(SPEEDS), initial_value="1×")
        closest = gui.add_button(
            "Closest approach", hint="Jump to the time of the closest approach of the worst flight."
        )
        self._camera: Any = gui.add_dropdown(
            "Camera",
            tuple(name.capitalize() for name in CAMERAS),
            initial_value=camera.capitalize(),
            hint="Chase goes with the vehicle, intruder with what comes closest; dragging the view ends that.",
        )
        self._readout = gui.add_html("")
        self._boxes = {one.style.key: gui.add_checkbox(_box(one), True) for one in flights.every}
        self._arrows(gui)
        self._finding.on_update(self._by_visitor(lambda: driver.choose(_label(self._finding.value))))
        self._slider.on_update(self._by_visitor(lambda: self.go(self._slider.value)))
        self._play.on_update(lambda _: driver.wake())
        closest.on_click(lambda _: self.go_to_closest())
        self._camera.on_update(self._by_visitor(self._look))
        for one in flights.every:
            self._toggle(self._boxes[one.style.key], one)
        self.offer((), shown)

    def _arrows(self, gui: viser.GuiApi) -> None:
        """What can be drawn along the flights."""
        vectors = self._vectors
        velocity: Any = gui.add_checkbox("Velocity", vectors.velocity, hint="Over ground: how fast the place changes.")
        relative: Any = gui.add_checkbox(
            "Relative velocity",
            vectors.relative,
            hint="The vehicle's minus that of the obstacle whose centre is nearest.",
        )
        trail: Any = gui.add_dropdown("Trail", TRAILS, hint="The path alike, or what is flown so far stronger.")
        self._note = gui.add_html("")

        def show(_: Any) -> None:
            with self._driver.drawing():
                vectors.show(velocity=velocity.value, relative=relative.value)

        def follow(_: Any) -> None:
            with self._driver.drawing():
                self._flights.trail(trail.value == TRAILS[1])

        velocity.on_update(show)
        relative.on_update(show)
        trail.on_update(follow)

    def _toggle(self, box: Any, one: Drawn) -> None:
        def changed(_: Any) -> None:
            one.show(box.value)
            self._driver.shown()

        box.on_update(changed)

    @staticmethod
    def _by_visitor(act: Any) -> Any:
        """Only what the visitor has changed; what is set from here has been done already."""
        return lambda event: act() if event.client_id is not None else None

    def _look(self) -> None:
        name = self._camera.value.lower()
        self._driver.look_from(cast(Camera, name) if name in CAMERAS else None)

    @property
    def playing(self) -> bool:
        """Whether time runs by itself."""
        return bool(self._play.value)

    def play(self, on: bool) -> None:
        """Let time run, or stand."""
        self._play.value = on

    def camera(self, kind: Camera | None) -> None:
        """Say from where the scene is looked at; None: from a place of the visitor's own."""
        names = tuple(name.capitalize() for name in CAMERAS)
        self._camera.options = names if kind else (*names, OWN)
        self._camera.value = kind.capitalize() if kind else OWN

    def offer(self, findings: Iterable[str], shown: str) -> None:
        """The findings that there are to choose from, and which is chosen."""
        labels = sorted({*findings, shown} - {NOMINAL}, key=lambda label: (len(label), label))
        self._finding.options = (*map(_title, labels), ALONE)
        self._finding.value = _title(shown)
        box = self._boxes[self._flights.chosen.style.key]
        box.visible, box.label = shown != NOMINAL, _box(self._flights.chosen, alone=shown == NOMINAL)

    def advance(self, seconds: float) -> None:
        """Let time run on, from the end to the beginning."""
        self.go_to((self.time + seconds * SPEEDS[self._speed.value]) % self._setting.horizon)

    def go(self, time: float) -> None:
        """Show this time, where the slider stands already."""
        with self._driver.drawing():
            self.time = self._held(time)
            self._driver.moved(self.time)

    def go_to(self, time: float) -> None:
        """Show this time."""
        with self._driver.drawing():
            self.go(time)
            self._slider.value = self.time

    def go_to_closest(self) -> None:
        """Show the closest approach of the worst flight there is."""
        time = self.closest_time()
        if time is not None:
            self._play.value = False
            self.go_to(time)

    def closest_time(self) -> float | None:
        """When the worst flight came closest [s]."""
        flights = [one.flight for one in self._flights.every if one.flight is not None and one.flight.closest]
        worst = min(flights, key=lambda flight: flight.closest.value if flight.closest else 0.0, default=None)
        return None if worst is None or worst.closest is None else worst.closest.time

    def moved(self, time: float) -> None:
        """Bring the readouts up to date."""
        separations = tables.separations(self._flights.every, self._setting, time)
        self._readout.content = separations + tables.speeds(self._flights.every, time, self._vectors.decimals)

    def changed(self) -> None:
        """The same for other flights."""
        self.moved(self.time)
        ahead = self._vectors.ahead
        arrows = f"An arrow is as long as the way of {ahead:g} s at that velocity. " if ahead else ""
        self._note.content = tables.note(f"{arrows}Dots every {self._flights.dots:g} s.")

    def _held(self, time: float) -> float:
        return min(max(time, 0.0), self._setting.horizon)


def _title(label: str) -> str:
    return ALONE if label == NOMINAL else label


def _label(title: str) -> str:
    return NOMINAL if title == ALONE else title


def _box(one: Drawn, alone: bool = False) -> str:
    return "Show finding" if alone else f"Show {one.style.title}"
