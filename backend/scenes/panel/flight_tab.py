"""The tab that replays the flights: which, time, play, cameras, what to show, readouts. Read `FlightTab`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, cast

import viser

from backend.scenes.base.address import CAMERAS, Camera
from backend.scenes.base.part import Driver, Part
from backend.scenes.base.schemas import SPEEDS, LayersChange, Trails
from backend.scenes.base.setting import NOMINAL, Setting
from backend.scenes.drawing.drawn import Drawn
from backend.scenes.drawing.flights import Flights
from backend.scenes.drawing.vectors import Vectors
from backend.scenes.panel import tables

PACES = {f"{speed:g}×": speed for speed in SPEEDS}
STEP = 0.01
"""Of the time slider [s]."""
OWN = "Own"
"""The camera that the visitor has moved."""
ALONE = "Nominal alone"
TRAILS: dict[str, Trails] = {"Whole": "whole", "So far": "so_far"}


class FlightTab(Part):
    """Holds the time shown; the driver is told of every new one."""

    def __init__(
        self,
        gui: viser.GuiApi,
        setting: Setting,
        flights: Flights,
        vectors: Vectors,
        driver: Driver,
        shown: str,
    ) -> None:
        self._setting, self._flights, self._vectors, self._driver = setting, flights, vectors, driver
        self.time = 0.0
        self._finding: Any = gui.add_dropdown(
            "Finding", (_title(shown),), hint="The finding that is shown beside the nominal flight."
        )
        self._slider: Any = gui.add_slider("Time [s]", 0.0, setting.horizon, STEP, 0.0)
        self._play: Any = gui.add_checkbox("Play", False)
        self._speed: Any = gui.add_dropdown("Speed", tuple(PACES), initial_value="1×")
        closest = gui.add_button(
            "Closest approach", hint="Jump to the time of the closest approach of the worst flight."
        )
        self._camera: Any = gui.add_dropdown(
            "Camera",
            tuple(name.capitalize() for name in CAMERAS),
            hint="Chase goes with the vehicle, intruder with what comes closest; dragging the view ends that.",
        )
        self._readout = gui.add_html("")
        self._boxes: dict[str, Any] = {one.style.key: gui.add_checkbox(_box(one), True) for one in flights.every}
        self._arrows(gui)
        self._finding.on_update(self._by_visitor(lambda: driver.choose(_label(self._finding.value))))
        self._slider.on_update(self._by_visitor(lambda: self.go(self._slider.value)))
        self._play.on_update(lambda _: driver.wake())
        self._speed.on_update(lambda _: driver.wake())
        closest.on_click(lambda _: self.go_to_closest())
        self._camera.on_update(self._by_visitor(self._look))
        for one in flights.every:
            self._toggle(self._boxes[one.style.key], one)
        self.offer((), shown)

    def _arrows(self, gui: viser.GuiApi) -> None:
        """What can be drawn along the flights."""
        vectors = self._vectors
        self._velocity: Any = gui.add_checkbox(
            "Velocity", vectors.velocity, hint="Over ground: how fast the place changes."
        )
        self._relative: Any = gui.add_checkbox(
            "Relative velocity",
            vectors.relative,
            hint="The vehicle's minus that of the obstacle whose centre is nearest.",
        )
        self._trail: Any = gui.add_dropdown("Trail", tuple(TRAILS), hint="All alike, or what is flown stronger.")
        self._note = gui.add_html("")

        def show(_: Any) -> None:
            with self._driver.drawing():
                vectors.show(velocity=self._velocity.value, relative=self._relative.value)

        def follow(_: Any) -> None:
            with self._driver.drawing():
                self._flights.trail(self.trail == "so_far")

        self._velocity.on_update(show)
        self._relative.on_update(show)
        self._trail.on_update(follow)

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

    @property
    def speed(self) -> float:
        """Seconds of the flight in a second."""
        return PACES[self._speed.value]

    @property
    def trail(self) -> Trails:
        """How the paths are drawn."""
        return TRAILS[self._trail.value]

    @property
    def layers(self) -> dict[str, bool]:
        """What of it is to be seen."""
        shown = {key.replace("-", "_"): bool(box.value) for key, box in self._boxes.items()}
        shown["finding"] = shown.pop("worst")
        return shown | {"velocity": self._velocity.value, "relative": self._relative.value}

    def have(self, layers: LayersChange, speed: float | None) -> None:
        """Show what is to be seen, and play so fast."""
        boxes = {"nominal": "nominal", "finding": "worst", "what_if": "what-if"}
        ticked = [(self._boxes[key], getattr(layers, name)) for name, key in boxes.items()]
        for box, wanted in (*ticked, (self._velocity, layers.velocity), (self._relative, layers.relative)):
            if wanted is not None:
                box.value = wanted  # which draws it
        if layers.trail is not None:
            self._trail.value = next(title for title, trail in TRAILS.items() if trail == layers.trail)
        if speed is not None:
            self._speed.value = next(title for title, pace in PACES.items() if pace == speed)

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
        self.go_to((self.time + seconds * self.speed) % self._setting.horizon)

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
