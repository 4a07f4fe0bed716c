"""One viewer: scene and panel of one browser socket, on a viser server of its own. Start reading at `Viewer`."""

from __future__ import annotations

import contextlib
import logging
import threading
import time

import sqlalchemy as sa
import viser

from backend.db.engine import read
from backend.scenes.address import Address, Camera
from backend.scenes.convergence_tab import ConvergenceTab
from backend.scenes.drawn import Drawn, Style
from backend.scenes.flight import Flight
from backend.scenes.flight_tab import FlightTab
from backend.scenes.live import Live
from backend.scenes.obstacles import Obstacles
from backend.scenes.palette import DARK, LIGHT, Palette, rgb
from backend.scenes.setting import NOMINAL, WORST, Progress, Setting
from backend.scenes.what_if_tab import WhatIfTab
from backend.scenes.world import World, move_camera, place_first_camera

FRAME = 1 / 30
"""Time between pictures while playing [s]."""

LOOK = 1.0
"""Time between looks at a run that is not over [s]."""

_log = logging.getLogger(__name__)


class Viewer:
    """Builds the scene, then keeps it moving and up to date until closed."""

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
        palette = DARK if address.dark else LIGHT
        server.gui.configure_theme(
            dark_mode=address.dark,
            show_logo=False,
            show_share_button=False,
            control_width="small",
            brand_color=rgb(palette.soft),
        )
        server.gui.main_panel.dock_right()
        server.gui.set_panel_label(f"{setting.run} · {setting.title}")
        self._lock = threading.RLock()
        with server.atomic():
            self._world = World(server, setting, palette)
            self._obstacles = Obstacles(server, setting, palette, self._world)
            self._nominal = self._drawn(Style("nominal", "Nominal", palette.nominal, 0, "bottom"))
            called = "Worst" if address.flight == WORST else address.flight
            self._worst = self._drawn(Style("worst", called, palette.worst, 1, "top"))
            self._what_if = self._drawn(Style("what-if", "What-if", palette.what_if, 2, "beyond"))
            alone = address.flight == NOMINAL
            self._all = tuple(
                d for d in (self._nominal, self._worst, self._what_if) if not alone or d is not self._worst
            )
            self._draw_stored(address.time or 0.0)
        self._wake = threading.Event()
        self._stopped = False
        self._panel(live, palette, address)
        closest = self._encounter()
        place_first_camera(server, self._world, address.camera, closest.closest if closest else None)
        self._thread = threading.Thread(target=self._run, name=f"viewer of {setting.run}", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Stop moving and flying."""
        self._stopped = True
        self._wake.set()
        self._tab_what_if.stop()
        self._thread.join()

    def _drawn(self, style: Style) -> Drawn:
        return Drawn(self._server, self._setting, self._world, style)

    def _panel(self, live: Live, palette: Palette, address: Address) -> None:
        gui = self._server.gui
        tabs = gui.add_tab_group()
        with tabs.add_tab("Flight"):
            self._tab_flight = FlightTab(
                gui,
                self._setting,
                self._all,
                address.time or 0.0,
                self._camera,
                self._wake.set,
                self._moved,
                self._obstacles.show,
            )
        with tabs.add_tab("What-if"):
            self._tab_what_if = WhatIfTab(gui, self._setting, live, self._what_if, self._fly)
            self._tab_what_if.offer(self._progress.findings)
        with tabs.add_tab("Convergence"):
            self._tab_convergence = ConvergenceTab(gui, self._setting, palette, self._progress.curves)
        if address.time is None:
            self._tab_flight.go_to_closest()

    def _run(self) -> None:
        """Advance time while playing, look at the run while it is not over, sleep otherwise."""
        then = looked = time.monotonic()
        while not self._stopped:
            playing = self._tab_flight.playing
            self._wake.wait(FRAME if playing else None if self._progress.over else LOOK)
            self._wake.clear()
            now = time.monotonic()
            if playing and not self._stopped:
                with self._lock, self._server.atomic():
                    self._tab_flight.advance(now - then)
            if not self._progress.over and now - looked >= LOOK:
                looked = now
                self._look()
            then = now

    def _look(self) -> None:
        try:
            with read(self._engine) as reader:
                if not self._progress.look(reader):
                    return
        except sa.exc.SQLAlchemyError:
            _log.exception("the run could not be read for its 3D view; trying again")
            return
        with self._lock, self._server.atomic():
            self._draw_stored(self._tab_flight.time)
            self._tab_what_if.offer(self._progress.findings)
            self._tab_convergence.refresh()
            self._tab_flight.refresh()

    def _draw_stored(self, time: float) -> None:
        new = {
            drawn: flight
            for name, drawn in {self._progress.shown: self._worst, NOMINAL: self._nominal}.items()
            if (flight := self._progress.flights.get(name)) is not None and flight is not drawn.flight
        }
        first = all(drawn.flight is None for drawn in self._all)
        if first and new:
            self._world.fit(list(new.values()))
        for drawn, flight in new.items():
            drawn.draw(flight, time)
        if new or first:
            self._obstacles.update(self._all, time)

    def _fly(self, flight: Flight) -> None:
        with self._lock, self._server.atomic():
            time = self._tab_flight.time
            self._what_if.draw(flight, time)
            self._obstacles.update(self._all, time)
            self._tab_flight.refresh()

    def _moved(self, time: float) -> None:
        with self._lock, self._server.atomic():
            for drawn in self._all:
                drawn.move(time)
            self._obstacles.move(time)

    def _encounter(self) -> Flight | None:
        return self._worst.flight or self._nominal.flight

    def _camera(self, kind: Camera) -> None:
        flight = self._encounter()
        with contextlib.suppress(KeyError):  # the browser has just gone
            move_camera(self._server, self._world, kind, flight.closest if flight else None)
