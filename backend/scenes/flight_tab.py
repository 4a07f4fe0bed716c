"""The tab that replays the flights: time, play, cameras, what to show, readouts. Start reading at `FlightTab`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, cast

import viser

from backend.scenes import tables
from backend.scenes.address import CAMERAS, Camera
from backend.scenes.drawn import Drawn
from backend.scenes.setting import Setting

SPEEDS = {"0.25×": 0.25, "0.5×": 0.5, "1×": 1.0, "2×": 2.0, "5×": 5.0}
STEP = 0.01
"""Of the time slider [s]."""


class FlightTab:
    """Holds the time shown; `moved` is called with every new one."""

    def __init__(
        self,
        gui: viser.GuiApi,
        setting: Setting,
        drawn: Sequence[Drawn],
        time: float,
        move_camera: Callable[[Camera], None],
        play_changed: Callable[[], None],
        moved: Callable[[float], None],
        shown: Callable[[], None],
    ) -> None:
        self._setting, self._drawn, self._moved, self._shown_changed = setting, drawn, moved, shown
        self.time = min(max(time, 0.0), setting.horizon)
        self._slider: Any = gui.add_slider("Time [s]", 0.0, setting.horizon, STEP, round(self.time, 2))
        self._play: Any = gui.add_checkbox("Play", False)
        self._speed: Any = gui.add_dropdown("Speed", tuple(SPEEDS), initial_value="1×")
        closest = gui.add_button(
            "Closest approach", hint="Jump to the time of the closest approach of the worst flight."
        )
        self._readout = gui.add_html(tables.separations(drawn, setting, self.time))
        self._shown = {one.style.key: gui.add_checkbox(f"Show {one.style.title}", True) for one in drawn}
        cameras: Any = gui.add_button_group("Camera", [name.capitalize() for name in CAMERAS])

        self._slider.on_update(lambda event: self.go(self._slider.value) if event.client is not None else None)
        self._play.on_update(lambda _: play_changed())
        closest.on_click(lambda _: self.go_to_closest())
        cameras.on_click(lambda _: move_camera(cast(Camera, cameras.value.lower())))
        for one in drawn:
            self._toggle(self._shown[one.style.key], one)

    def _toggle(self, box: Any, one: Drawn) -> None:
        def changed(_: Any) -> None:
            one.show(box.value)
            self._shown_changed()

        box.on_update(changed)

    @property
    def playing(self) -> bool:
        """Whether time runs by itself."""
        return bool(self._play.value)

    def advance(self, seconds: float) -> None:
        """Let time run on, from the end to the beginning."""
        self.go((self.time + seconds * SPEEDS[self._speed.value]) % self._setting.horizon)
        self._slider.value = self.time

    def go(self, time: float) -> None:
        """Show this time."""
        self.time = time
        self._moved(time)
        self.refresh()

    def go_to_closest(self) -> None:
        """Show the closest approach of the worst flight there is."""
        time = self.closest_time()
        if time is not None:
            self._play.value = False
            self.go(time)
            self._slider.value = time

    def closest_time(self) -> float | None:
        """When the worst flight came closest [s]."""
        flights = [one.flight for one in self._drawn if one.flight is not None and one.flight.closest is not None]
        worst = min(flights, key=lambda flight: flight.closest.value if flight.closest else 0.0, default=None)
        return None if worst is None or worst.closest is None else worst.closest.time

    def refresh(self) -> None:
        """Bring the readouts up to date."""
        self._readout.content = tables.separations(self._drawn, self._setting, self.time)
