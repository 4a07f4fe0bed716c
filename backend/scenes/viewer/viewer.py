"""One viewer: scene and panel of one browser socket, on a viser server of its own. Start reading at `Viewer`."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import sqlalchemy as sa
import viser

from backend.db.engine import read
from backend.scenes.base.address import Address, Camera
from backend.scenes.base.palette import DARK, LIGHT, rgb
from backend.scenes.base.part import Part
from backend.scenes.base.schemas import ViewChange, ViewState
from backend.scenes.base.setting import Progress, Setting
from backend.scenes.drawing.flights import Flights
from backend.scenes.drawing.following import FRAME, Following
from backend.scenes.drawing.vectors import Vectors
from backend.scenes.drawing.world import World
from backend.scenes.live.live import Live
from backend.scenes.panel.flight_tab import STEP
from backend.scenes.viewer.panel import Panel

LOOK = 1.0
"""Time between looks at a run that is not over [s]."""

_log = logging.getLogger(__name__)


class GoneError(Exception):
    """The viewer has been closed."""


class UnknownFlightError(ValueError):
    """The run has no such finding; the message says which it has."""


class Viewer:
    """Builds the scene, then keeps it moving and up to date until closed; it drives its parts (`Driver`)."""

    def __init__(
        self,
        server: viser.ViserServer,
        engine: sa.Engine,
        live: Live,
        setting: Setting,
        progress: Progress,
        address: Address,
    ) -> None:
        self._server, self._engine, self._setting, self._progress = server, engine, setting, progress
        self._lock = threading.RLock()
        self._wake = threading.Event()
        self._stopped = False
        self._opened = time.time()
        self.revision = int(1000 * self._opened)
        """Grows with everything that is shown otherwise; that of a later viewer is higher."""
        self.on_news: Callable[[], None] = lambda: None
        """Called after that, from any thread, and when the viewer is closed."""
        self._depth, self._ready = 0, False
        self._said: dict[str, Any] = {}
        self._dark = address.dark
        self._theme()
        server.gui.main_panel.dock_right()
        # Beside its page, which has the run's name and controls of its own, the scene is what is looked at.
        alone = address.key is None
        self._unfold(alone)
        server.gui.set_panel_label(f"{setting.run} · {setting.title}" if alone else "What-if, space, search")
        palette = DARK if address.dark else LIGHT
        with server.atomic():
            self._world = World(server, setting, palette)
            self._flights = Flights(server, setting, self._world, palette, progress)
            self._vectors = Vectors(server, setting, self._world, palette, self._flights)
            self._following = Following(server, self._world, self._flights, address.camera, self.wake)
            self._parts: list[Part] = [self._flights, self._vectors, self._following]
            self._flights.moved(address.time or 0.0)
            self._flights.stored()
            self._panel = Panel(
                server,
                engine,
                live,
                setting,
                progress,
                self._world,
                self._flights,
                self._vectors,
                self._following,
                self,
            )
            self._tab = self._panel.flight
            self._parts += self._panel.parts
            self._following.on_own = self._say_own
            self._begin(address)
        self._ready = True
        self._note()
        self._thread = threading.Thread(target=self._run, name=f"viewer of {setting.run}", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Stop moving and flying."""
        with self._lock:
            self._stopped = True
        self.on_news()
        self.wake()
        for part in self._parts:
            part.stop()
        self._thread.join()

    def _begin(self, address: Address) -> None:
        """At the address's time and camera; without a time at the closest approach."""
        self._tab.camera(address.camera)
        closest = self._tab.closest_time()
        self._tab.go_to(closest if address.time is None and closest is not None else address.time or 0.0)
        self._following.first(self._tab.time)
        self.changed()

    @contextmanager
    def drawing(self) -> Iterator[None]:
        """One change of scene and panel: nobody else changes them meanwhile, and it is seen at once."""
        with self._lock:
            with self._server.atomic():
                self._depth += 1
                try:
                    yield
                finally:
                    self._depth -= 1
            if self._depth == 0:
                self._note()

    def wake(self) -> None:
        """There is something to do for the viewer's own thread."""
        self._wake.set()

    def moved(self, time: float) -> None:
        """Show everything at this time [s]."""
        with self.drawing():
            for part in self._parts:
                part.moved(time)

    def shown(self) -> None:
        """What is to be seen of the flights has changed."""
        with self.drawing():
            self._flights.obstacles.show()
            self.changed()

    def look_from(self, camera: Camera | None) -> None:
        """Look from there; from None: stay, and follow nothing."""
        self._following.set(camera)
        with self.drawing():
            self._tab.camera(camera)

    def _say_own(self) -> None:
        with self.drawing():
            self._tab.camera(self._following.camera)

    def choose(self, flight: str) -> None:
        """Show this finding beside the nominal flight, or that one alone; from one closest approach to the next."""
        with self.drawing():
            if flight == self._progress.shown:
                return
            if self._progress.findings and flight not in self._progress.choices:
                known = ", ".join(self._progress.choices)
                raise UnknownFlightError(f"{self._setting.run} has no finding {flight!r}: choose one of {known}")
            closest = self._tab.closest_time()
            with read(self._engine) as reader:
                self._progress.show(flight, reader)
            self._flights.choose()
            after = self._tab.closest_time()
            if None not in (closest, after) and abs(self._tab.time - (closest or 0.0)) <= STEP:
                self._tab.go_to(after or 0.0)
            self.changed()

    def steer(self, change: ViewChange) -> ViewState:
        """Do what the page asks, all of it in one picture.

        Raises `GoneError`, `UnknownFlightError` for a finding, `UnknownParameterError` for a what-if or an axis.

        Going to a time stops the play, unless it is asked to go on in the same breath.
        """
        with self.drawing():
            if self._stopped:
                raise GoneError
            if change.flight is not None:
                self.choose(change.flight)
            if change.theme is not None and (change.theme == "dark") != self._dark:
                self._paint(change.theme == "dark")
            if change.panel is not None:
                self._unfold(change.panel)
            self._panel.have(change)
            self._steer_time(change)
            if change.camera is not None:
                self.look_from(change.camera)
            if change.eye is not None:
                self._following.place((np.array(change.eye.position), np.array(change.eye.target)))
                self._tab.camera(None)
        return self.state()

    def _steer_time(self, change: ViewChange) -> None:
        if change.closest:
            self._tab.go_to_closest()
        if (change.time is not None or change.step is not None) and not (change.passing and self._tab.playing):
            self._tab.play(False)
            self._tab.go_to((self._tab.time if change.time is None else change.time) + (change.step or 0.0))
        if change.playing is not None:
            self._tab.play(change.playing)

    def state(self) -> ViewState:
        """What is shown now; raises `GoneError`."""
        with self._lock:
            if self._stopped:
                raise GoneError
            return ViewState(opened=self._opened, revision=self.revision, **self._shown())

    def _shown(self) -> dict[str, Any]:
        """All of the state that may be steered."""
        camera, eye = self._following.camera, self._following.eye
        return {
            "flight": self._progress.shown,
            "time": self._tab.time,
            "camera": camera,
            "eye": None if camera or eye is None else {"position": eye[0].tolist(), "target": eye[1].tolist()},
            "playing": self._tab.playing,
            "theme": "dark" if self._dark else "light",
            "panel": self._unfolded,
            **self._panel.shown(),
        }

    def _note(self) -> None:
        """Tell whoever listens, where something is shown otherwise than before."""
        if self._stopped or not self._ready:
            return
        shown = self._shown()
        if shown != self._said:
            self._said, self.revision = shown, self.revision + 1
            self.on_news()

    def _paint(self, dark: bool) -> None:
        self._dark = dark
        self._theme()
        palette = DARK if dark else LIGHT
        self._world.paint(palette)
        for part in self._parts:
            part.paint(palette)
        self.changed()

    def _unfold(self, panel: bool) -> None:
        """Show or fold the panel. Its visitor may do so, too, and is not heard of."""
        self._unfolded, main = panel, self._server.gui.main_panel
        main.expand() if panel else main.minimize()

    def _theme(self) -> None:
        self._server.gui.configure_theme(
            dark_mode=self._dark,
            show_logo=False,
            show_share_button=False,
            control_width="small",
            brand_color=rgb((DARK if self._dark else LIGHT).soft),
        )

    def _run(self) -> None:
        """Advance time while playing, look at the run while it is not over, sleep otherwise."""
        then = looked = time.monotonic()
        while not self._stopped:
            playing = self._tab.playing
            busy = playing or self._following.due
            self._wake.wait(FRAME if busy else None if self._progress.over else LOOK)
            now = time.monotonic()
            with self.drawing():
                if playing and self._tab.playing and not self._stopped:  # it may have been stopped while this waited
                    self._tab.advance(now - then)
            self._following.work(now)
            if not self._progress.over and now - looked >= LOOK:
                looked = now
                self._look()
            then = now
            # Cleared last: what is done here wakes, too; whoever else did has noted before what there is to do.
            self._wake.clear()

    def _look(self) -> None:
        try:
            with read(self._engine) as reader:
                if not self._progress.look(reader):
                    return
        except sa.exc.SQLAlchemyError:
            _log.exception("the run could not be read for its 3D view; trying again")
            return
        with self.drawing():
            self._flights.stored()
            self.changed()

    def changed(self) -> None:
        """Flights, findings or evaluations are others than before, or others are shown."""
        self._tab.offer(self._progress.findings, self._progress.shown)
        for part in self._parts:
            part.changed()
