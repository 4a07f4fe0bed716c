"""One viewer: scene and panel of one browser socket, on a viser server of its own."""

from __future__ import annotations

import contextlib
import logging
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import sqlalchemy as sa
import viser

from backend.db.engine import read
from backend.http.errors import RefusedError
from backend.scenes.base.address import Address
from backend.scenes.base.flight import Flight
from backend.scenes.base.palette import DARK, LIGHT, rgb
from backend.scenes.base.part import Part
from backend.scenes.base.progress import Progress
from backend.scenes.base.schemas import LayersChange, ViewChange, ViewState
from backend.scenes.base.setting import Setting
from backend.scenes.drawing.flights import Flights
from backend.scenes.drawing.following import FRAME, Following
from backend.scenes.drawing.labels import Labels, Tag
from backend.scenes.drawing.vectors import Vectors
from backend.scenes.drawing.world import World
from backend.scenes.live.live import Live
from backend.scenes.viewer.panel import Panel
from backend.scenes.viewer.replay import STEP, Replay
from backend.scenes.viewer.what_if import WhatIf

LOOK = 1.0
"""Polling interval of an active run [s]."""

_log = logging.getLogger(__name__)


FAILED = "The 3D view ended with an error, which the log of the service describes: open it again"


class GoneError(Exception):
    """The viewer has been closed."""


class FailedError(GoneError):
    """The viewer ended with an error; its socket may still be open."""


class Viewer:
    """Builds the scene, then animates and updates it until closed; drives its parts (`Driver`)."""

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
        self.failed = False
        """Whether its own thread ended with an error; set once, from that thread."""
        self._opened = time.time()
        self.revision = int(1000 * self._opened)
        """Increases with every change of the display; higher for later viewers."""
        self.on_news: Callable[[], None] = lambda: None
        """Called after a change, from any thread, and when the viewer is closed."""
        self._depth, self._ready = 0, False
        self._statement: dict[str, Any] = {}
        self._dark = address.dark
        self._theme()
        server.gui.main_panel.dock_right()
        # The page already shows the run's name and controls; the panel starts folded in favour of the scene.
        alone = address.key is None
        self._unfold(alone)
        server.gui.set_panel_label(f"{setting.run} · {setting.title}" if alone else "Details")
        palette = DARK if address.dark else LIGHT
        with server.atomic():
            self._world = World(server, setting, palette)
            self._flights = Flights(server, setting, self._world, palette, progress)
            self._vectors = Vectors(server, setting, self._world, palette, self._flights)
            self._following = Following(server, self._world, self._flights, address.camera, self.wake)
            self._labels = Labels(self._tags, lambda: self._following.view)
            self._parts: list[Part] = [self._flights, self._vectors, self._following, self._labels]
            self._flights.moved(address.time or 0.0)
            self._flights.stored()
            self._replay = Replay(setting, self._flights, self._vectors, self)
            self._what_if = WhatIf(setting, live, self._flights.what_if, self._fly, self)
            scene = (self._world, self._flights, self._vectors)
            self._panel = Panel(server, engine, live, setting, progress, *scene, self)
            self._parts += [self._what_if, *self._panel.parts]
            self._following.on_own = self._note
            self._begin(address)
        self._ready = True
        self._note()
        self._thread = threading.Thread(target=self._run, name=f"viewer of {setting.run}", daemon=True)
        self._thread.start()

    def close(self) -> None:
        with self._lock:
            self._stopped = True
        self.on_news()
        self.wake()
        for part in self._parts:
            part.stop()
        self._thread.join()

    def _begin(self, address: Address) -> None:
        closest = self._replay.closest_time()
        self._replay.go_to(closest if address.time is None and closest is not None else address.time or 0.0)
        self._following.first(self._replay.time)
        self.changed()

    def _tags(self, time: float) -> Iterator[Tag]:
        """The labels of the scene at a time [s]; the first ones have precedence."""
        yield from self._flights.tags(time)
        yield from (self._vectors.tag,) if self._vectors.tag is not None else ()
        yield from self._world.tags()

    @contextlib.contextmanager
    def drawing(self) -> Iterator[None]:
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
        self._wake.set()

    def moved(self, time: float) -> None:
        with self.drawing():
            for part in self._parts:
                part.moved(time)

    def shown(self) -> None:
        with self.drawing():
            self._flights.obstacles.show()
            self.changed()

    def _fly(self, flight: Flight | None) -> None:
        self._flights.show_what_if(flight)
        self.changed()

    def show_what_if(self, flight: Flight | None, seed: int | None, order: int) -> None:
        """Draw this flight as the what-if, unless one of a higher order is drawn; raises `GoneError`, `FailedError`.

        flight: None if it has no motion.
        seed: the requested noise seed; None for those of the campaign.
        """
        with self.drawing():
            self._intact()
            self._what_if.draw(flight, seed, order)

    def choose(self, flight: str) -> None:
        """Show this finding with the nominal flight, or the nominal flight alone, at the closest approach."""
        with self.drawing():
            if flight == self._progress.shown:
                return
            if self._progress.findings and flight not in self._progress.choices:
                known = ", ".join(self._progress.choices)
                text = f"{self._setting.run} has no finding {flight!r}: choose one of {known}"
                raise RefusedError("unknown-finding", text)
            closest = self._replay.closest_time()
            with read(self._engine) as reader:
                self._progress.show(flight, reader)
            self._flights.choose()
            after = self._replay.closest_time()
            if None not in (closest, after) and abs(self._replay.time - (closest or 0.0)) <= STEP:
                self._replay.go_to(after or 0.0)
            self.changed()

    def steer(self, change: ViewChange) -> ViewState:
        """Apply a change requested by the page, in one frame.

        Raises `GoneError`, `FailedError`, and `RefusedError` for a finding or a what-if.
        """
        with self.drawing():
            self._intact()
            if change.flight is not None:
                self.choose(change.flight)
            if change.theme is not None and (change.theme == "dark") != self._dark:
                self._paint(change.theme == "dark")
            if change.panel is not None:
                self._unfold(change.panel)
            if change.what_if is not None:
                self._what_if.simulate(change.what_if, change.what_if_seed)
            layers = change.layers or LayersChange()
            self._panel.have(layers)
            self._replay.have(layers)
            self._replay.steer(change)
            if change.camera is not None:
                self._following.set(change.camera)
            if change.eye is not None:
                self._following.set(None, (np.array(change.eye.position), np.array(change.eye.target)))
        return self.state()

    def state(self) -> ViewState:
        """The current state; raises `GoneError`, `FailedError`."""
        with self._lock:
            self._intact()
            return ViewState(opened=self._opened, revision=self.revision, **self._shown())

    def _shown(self) -> dict[str, Any]:
        camera, eye = self._following.camera, self._following.eye
        return {
            "flight": self._progress.shown,
            "camera": camera,
            "eye": None if camera or eye is None else {"position": eye[0].tolist(), "target": eye[1].tolist()},
            "theme": "dark" if self._dark else "light",
            "panel": self._unfolded,
            **self._replay.shown,
            "layers": self._replay.layers | self._panel.layers,
            **self._what_if.shown,
        }

    def _note(self) -> None:
        if self._stopped or not self._ready:
            return
        shown = self._shown()
        if shown != self._statement:
            self._statement, self.revision = shown, self.revision + 1
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
        """Show or fold the panel. The visitor can do the same in the view, which is not reported to the page."""
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

    def _intact(self) -> None:
        if self._stopped:
            raise GoneError
        if self.failed:
            raise FailedError

    def _run(self) -> None:
        """The viewer's own thread; an error ends it, and is reported to the log, in the view and to its page."""
        try:
            self._animate()
        except Exception:
            _log.exception("the 3D view of %s ended with an error", self._setting.run)
            with self._lock:
                self.failed = True
            self.on_news()
            with contextlib.suppress(Exception):  # the log and the page have it already
                self._report()

    def _report(self) -> None:
        for client in self._server.get_clients().values():
            client.add_notification("3D view ended", f"{FAILED}.", color="red")
            client.flush()

    def _animate(self) -> None:
        """Advance the time during playback, poll the run while it is active, sleep otherwise."""
        then = looked = time.monotonic()
        while not self._stopped:
            playing = self._replay.playing
            busy = playing or self._following.due
            self._wake.wait(FRAME if busy else None if self._progress.over else LOOK)
            now = time.monotonic()
            with self.drawing():
                if playing and self._replay.playing and not self._stopped:  # may be paused by now
                    self._replay.advance(now - then)
            self._following.work(now)
            if self._labels.due and not self._stopped:
                with self.drawing():
                    self._labels.arrange()
            if not self._progress.over and now - looked >= LOOK:
                looked = now
                self._look()
            then = now
            # Cleared last, because the work above sets the event too; other threads record requests first.
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
        for part in self._parts:
            part.changed()
