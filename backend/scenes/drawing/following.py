"""The camera of one viewer: fixed, following the vehicle, or moved by the visitor.

The browser reports every camera movement, including those that it was sent. The positions sent are recorded, so that
any other movement is recognised as the visitor's: it ends the following. Sending a new position every frame would hide
what the visitor does: the next one is sent a frame after the browser has reached the last.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Any

import numpy as np
import viser
from viser._messages import ViewerCameraMessage

from backend.scenes.base.address import Camera
from backend.scenes.base.axes import Floats
from backend.scenes.base.part import Part
from backend.scenes.drawing.cameras import ASPECT, MOVING, Pose, begin_at, pose
from backend.scenes.drawing.flights import Flights
from backend.scenes.drawing.labels import HEIGHT, View
from backend.scenes.drawing.world import World

FRAME = 1 / 30
"""Minimum time between camera movements [s]."""
PATIENCE = 0.4
"""A browser that does not confirm a position is sent the next one after this time [s]."""
REMEMBERED = 300
"""Number of recorded positions: 10 s of them for a slow browser."""
NARROWEST, WIDEST = 0.6, 1.8
"""Aspect ratios are limited to this range, because labels need space at the sides."""
OWN = 1e-3
"""Relative tolerance for recognising a position that was sent, as a fraction of the distance to the target."""


class Following(Part):
    """Stores the named camera: None once the visitor has moved it."""

    def __init__(
        self, server: viser.ViserServer, world: World, flights: Flights, camera: Camera, wake: Callable[[], None]
    ) -> None:
        self.camera: Camera | None = camera
        self.on_own: Callable[[], None] = lambda: None
        """Called by `work` after the visitor has moved the camera."""
        self._server, self._world, self._flights, self._wake = server, world, flights, wake
        self._aspect = ASPECT
        """Aspect ratio of the browser's viewport."""
        self._size = (ASPECT * HEIGHT, HEIGHT)
        """Size of the browser's viewport [px]."""
        self._at: Pose | None = None
        """The camera position last reported by the browser."""
        self._place: Pose | None = None
        """An unnamed position set by the page, until the visitor moves the camera."""
        self._sent_eyes: deque[Floats] = deque(maxlen=REMEMBERED)
        self._heard = self._left = False
        self._lock = threading.Lock()
        self._time, self._due = 0.0, False
        self._last = self._next = 0.0
        """Times of the last and of the earliest next camera movement [s]."""
        self._sent: set[int] = set()
        """The browsers that were sent a position."""
        server.on_client_connect(self._connected)

    def first(self, time: float) -> None:
        """Set the initial camera, also used by "Reset View"."""
        self._time = time
        begin_at(self._server, self._remembered(self._pose(self.camera or "overview")), self._world.frame.span)

    def set(self, camera: Camera | None, place: Pose | None = None) -> None:
        """Go to a named camera, or to a place without a name."""
        with self._lock:
            self.camera, self._place, self._heard, self._next = camera, place, False, 0.0
            self._due = camera is not None or place is not None
        self._wake()

    @property
    def eye(self) -> Pose | None:
        return self._place or self._at

    @property
    def view(self) -> View:
        found = self._pose(self.camera) if self.camera is not None else self.eye or self._pose("overview")
        return View(*found, *self._size)

    def moved(self, time: float) -> None:
        self._time = time
        if self.camera in MOVING:
            self._due = True
            self._wake()

    def changed(self) -> None:
        if self.camera in (*MOVING, "encounter"):
            self._due = True
            self._wake()

    @property
    def due(self) -> bool:
        return self._due

    def work(self, now: float) -> None:
        """Move the camera if due, respecting the minimum time between movements."""
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
            # A browser can disconnect at any time; viser then drops what is sent, and its warning is suppressed.
            with connection.get_message_buffer().sanctioned_dead_writes(), client.atomic():
                client.camera.position = eye
                client.camera.look_at = target

    def _pose(self, camera: Camera) -> Pose:
        return pose(camera, self._world.whole, self._flights.sight(self._time), self._aspect)

    def _remembered(self, found: Pose) -> Pose:
        self._sent_eyes.append(found[0])
        return found

    def _connected(self, client: viser.ClientHandle) -> None:
        connection: Any = client._websock_connection
        connection.register_handler(ViewerCameraMessage, self._seen)
        self._fit(client.camera)
        with self._lock:
            if client.client_id in self._sent:  # the client list already contains the browser here
                return
            self._due, self._next = self.camera is not None or self._place is not None, 0.0
        self._wake()

    def _seen(self, _: int, message: ViewerCameraMessage) -> None:
        """Handle a camera movement reported by the browser, sent or by the visitor.

        The message itself: viser's handle of the camera also takes on what is sent, which `work`, in another thread,
        may do before the handle is read. The browser would seem to have come to where it was only sent.
        """
        eye, target = np.array(message.position), np.array(message.look_at)
        near = OWN * float(np.linalg.norm(eye - target))
        with self._lock:
            if self._sent_eyes and float(np.linalg.norm(eye - self._sent_eyes[-1])) <= near:
                # Wait as long again as the confirmation took: about one frame, and at most 30 per second.
                now = time.monotonic()
                self._next = min(self._next, max(now + min(now - self._last, PATIENCE), self._last + 0.9 * FRAME))
            if any(float(np.linalg.norm(eye - position)) <= near for position in self._sent_eyes):
                self._heard = True
            elif self._heard and self.camera is not None:
                self.camera, self._due, self._left = None, False, True
            elif self._heard:
                self._place = None
            self._at = eye, target
            self._fit(message)
            if self.camera is None:
                self._wake()
            # Until the browser confirms the new position, it reports the old one.

    def _fit(self, shown: viser.CameraHandle | ViewerCameraMessage) -> None:
        size = (float(shown.image_width), float(shown.image_height))
        if size != self._size and min(size) > 0.0:  # a frame that is not shown yet has no size
            self._size = size
            self._aspect = min(max(size[0] / size[1], NARROWEST), WIDEST)
            self._wake()
