"""The camera of one viewer: set to a place, going with the vehicle, or the visitor's own. Start reading at `Following`.

The browser tells every movement of its camera, also those that it was told to make. What it was told is remembered, so
that a movement to anywhere else is known to be the visitor's own: it ends the following. A browser that is sent on in
every picture would never show what its visitor does: it is sent on once it has come there, and a picture later.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Any

import numpy as np
import viser

from backend.scenes.base.address import Camera
from backend.scenes.base.part import Part
from backend.scenes.drawing.cameras import ASPECT, FIELD_OF_VIEW, MOVING, Floats, Pose, pose
from backend.scenes.drawing.flights import Flights
from backend.scenes.drawing.world import World

FRAME = 1 / 30
"""Time between movements of the camera at least [s]."""
PATIENCE = 0.4
"""A browser that does not say that it has come to where it was sent is sent on after this time [s]."""
REMEMBERED = 300
"""So many places told to a browser are remembered: 10 s of them for one that is slow to draw."""
NARROWEST, WIDEST = 0.6, 1.8
"""Width by height of a picture, as far as cameras make use of it: labels stand at the sides."""
OWN = 1e-3
"""A place further off than this share of its distance from what is looked at is not the one told."""


class Following(Part):
    """Holds where the camera stands by name: None once the visitor has moved it."""

    def __init__(
        self, server: viser.ViserServer, world: World, flights: Flights, camera: Camera, wake: Callable[[], None]
    ) -> None:
        self.camera: Camera | None = camera
        self.on_own: Callable[[], None] = lambda: None
        """Called by `work` after the visitor has moved the camera."""
        self._server, self._world, self._flights, self._wake = server, world, flights, wake
        self._aspect = ASPECT
        """Of the browser's picture."""
        self._at: Pose | None = None
        """Where the browser said last that its camera stands."""
        self._place: Pose | None = None
        """Where it is sent to without a name, until its visitor moves it."""
        self._told: deque[Floats] = deque(maxlen=REMEMBERED)
        self._heard = self._left = False
        self._lock = threading.Lock()
        self._time, self._due = 0.0, False
        self._last = self._next = 0.0
        """When the camera was moved last, and when it may be moved next [s]."""
        self._sent: set[int] = set()
        """The browsers that were sent somewhere."""
        server.on_client_connect(self._connected)

    def first(self, time: float) -> None:
        """Where the camera stands when the page opens, and goes back to on "Reset View"."""
        self._time = time
        span = self._world.frame.span
        initial: Any = self._server.initial_camera
        initial.fov = FIELD_OF_VIEW
        initial.position, initial.look_at = self._remembered(self._pose(self.camera or "overview"))
        # viser draws the background one metre off: nothing of it would be left behind a farther near plane.
        initial.near, initial.far = min(0.005 * span, 0.5), 100 * span

    def set(self, camera: Camera | None) -> None:
        """Go there, and follow where it moves."""
        with self._lock:
            self.camera, self._place, self._heard, self._due, self._next = camera, None, False, camera is not None, 0.0
        self._wake()

    def place(self, eye: Pose) -> None:
        """Go to a place that has no name, and stay."""
        with self._lock:
            self.camera, self._place, self._heard, self._due, self._next = None, eye, False, True, 0.0
        self._wake()

    @property
    def eye(self) -> Pose | None:
        """Where the camera stands that has no name; None while nobody has said."""
        return self._place or self._at

    def moved(self, time: float) -> None:
        """Go along, as soon as may be."""
        self._time = time
        if self.camera in MOVING:
            self._due = True
            self._wake()

    def changed(self) -> None:
        """Another flight has another closest approach."""
        if self.camera in (*MOVING, "encounter"):
            self._due = True
            self._wake()

    @property
    def due(self) -> bool:
        """Whether the camera is not where it should be."""
        return self._due

    def work(self, now: float) -> None:
        """Move the camera, if that is due and the last movement long enough ago."""
        if self._left:
            self._left = False
            self.on_own()
        with self._lock:
            if not self._due or now < self._next:
                return
            self._due, self._last, self._next = False, now, now + PATIENCE
            wanted = self._place if self.camera is None else self._pose(self.camera)
            if wanted is None:
                return
            eye, target = self._remembered(wanted)
            clients = self._server.get_clients()
            self._sent.update(clients)
        for client in clients.values():
            connection: Any = client._websock_connection
            # A browser may leave at any moment: viser drops what is sent to it then, and need not warn.
            with connection.get_message_buffer().sanctioned_dead_writes(), client.atomic():
                client.camera.position = eye
                client.camera.look_at = target

    def _pose(self, camera: Camera) -> Pose:
        return pose(camera, self._world.whole, self._flights.sight(self._time), self._aspect)

    def _remembered(self, found: Pose) -> Pose:
        self._told.append(found[0])
        return found

    def _connected(self, client: viser.ClientHandle) -> None:
        client.camera.on_update(self._seen)
        self._aspect = min(max(client.camera.aspect, NARROWEST), WIDEST)
        with self._lock:
            if client.client_id in self._sent:  # it was among the browsers before this was called
                return
            self._due, self._next = self.camera is not None or self._place is not None, 0.0
        self._wake()

    async def _seen(self, camera: viser.CameraHandle) -> None:
        """The browser's camera has moved: as told, or not.

        On viser's event loop, where the handle still says what has come: a callback in a thread would read what was
        told meanwhile.
        """
        eye, target = np.array(camera.position), np.array(camera.look_at)
        near = OWN * float(np.linalg.norm(eye - target))
        with self._lock:
            if self._told and float(np.linalg.norm(eye - self._told[-1])) <= near:
                # As long again as it took to get there: about one picture, and 30 a second at most.
                now = time.monotonic()
                self._next = min(self._next, max(now + min(now - self._last, PATIENCE), self._last + 0.9 * FRAME))
            if any(float(np.linalg.norm(eye - told)) <= near for told in self._told):
                self._heard = True
            elif self._heard and self.camera is not None:
                self.camera, self._due, self._left = None, False, True
            elif self._heard:
                self._place = None
            self._at = eye, target
            self._aspect = min(max(camera.aspect, NARROWEST), WIDEST)
            if self.camera is None:
                self._wake()
            # Until the browser has come to where it was sent, this is where it was before.
