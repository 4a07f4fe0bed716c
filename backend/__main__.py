"""`python -m backend`: migrates the database, prints a login link, serves until it is stopped.

The link goes to standard output only, never into a file; `clearance serve` redirects this output to a log and therefore
prints its own link.
"""

from __future__ import annotations

from campaigns import heap, logs  # first: loading is not interrupted

# isort: split
import asyncio
import logging
import os
import signal
import socket
import sys

import sqlalchemy as sa
import uvicorn
from fastapi import FastAPI
from starlette.applications import Starlette

from backend.app import create
from backend.db.access import create_login_code
from backend.db.alone import alone
from backend.db.availability import awaited
from backend.db.outages import worded
from backend.db.private import keep_private, write_private
from backend.db.registry import registered
from backend.http.pages import unbuilt
from backend.middleware.connections import bounded
from backend.middleware.doors import Doors
from backend.middleware.frame import headers
from backend.middleware.sockets import bounded_socket
from backend.scenes.control.messages import LARGEST
from backend.settings import Settings
from backend.waiting import until_it_answers

heap.loaded()
heap.shared()

ADDRESS_FILE = "service-address"
"""File in the data folder with the service's address, for `clearance login-link`."""

OLD_LINK_FILE = "login-link"
"""File with a login link, written by earlier versions; removed at start."""

IDLE = 75
"""Time after which an idle connection is closed [s]; whoever closes first can lose a request that is on its way.

Proxies and clients close theirs within 60 s (nginx, load balancers). uvicorn has 5 s, as has httpx.
"""
GRACE = 1
"""Time limit of pending responses when the service stops [s]."""

ACCEPTED, WAITING = 16, 1024
"""Connections that are accepted at a time, so that those accepted before are read in between, and those that the system
holds until then.
"""


class Listening(uvicorn.Server):
    """Holds more connections than it accepts at a time."""

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        for listening in sockets or ():
            listening.listen(WAITING)


class Server(Listening):
    """Ends event streams, 3D views and previews first when it stops; otherwise they would delay the shutdown."""

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        app = self.config.app
        assert isinstance(app, FastAPI)
        app.state.hub.stop()
        app.state.frames.stop()
        app.state.viewers.stop()
        app.state.previews.stop()
        await super().shutdown(sockets)


def main() -> int:
    """Serve; returns 2 if the settings or the database cannot be used."""
    try:
        logs.set_up(os.environ, "%(levelname)s %(name)s: %(message)s")
    except ValueError as error:
        print(f"clearance: {error}", file=sys.stderr)
        return 2
    logging.getLogger("alembic").setLevel(logging.WARNING)
    logging.getLogger("websockets").setLevel(logging.WARNING)
    logging.getLogger("uvicorn").setLevel(logging.ERROR)  # it warns of each unreadable request, which anybody can send
    try:
        settings = Settings.load()
        for sentence in filter(None, [*Settings.unknown(os.environ), unbuilt(settings.pages)]):
            logging.getLogger("clearance").warning(sentence)
        keep_private(settings.data, settings.database_url)
        with alone(settings.data, settings.database_url, "backend.lock"):
            away = awaited(settings.database_url)
            listening = _listen(settings)
            if away is None or until_it_answers(settings, away, listening, _waiting):
                _serve(settings, listening)
    except (ValueError, OSError, sa.exc.SQLAlchemyError) as error:
        print(f"clearance: {worded(error)}", file=sys.stderr)
        return 2
    return 0


def _serve(settings: Settings, listening: socket.socket) -> None:
    app = create(settings)
    _announce(app, settings, listening.getsockname()[1])
    server = Server(server_config(app))
    _ended_by_signals(server)
    with registered(settings.data, settings.database_url, settings.url(listening.getsockname()[1])):
        asyncio.run(server.serve([listening]))


def _waiting(app: Starlette) -> uvicorn.Server:
    server = Listening(server_config(app))
    _ended_by_signals(server)
    return server


def _ended_by_signals(server: uvicorn.Server) -> None:
    for number in (signal.SIGTERM, signal.SIGINT):  # uvicorn raises them again after its shutdown; ignore them
        signal.signal(number, lambda *_: setattr(server, "should_exit", True))


def server_config(app: Starlette) -> uvicorn.Config:
    """Sockets without per-message deflate, which makes the 3D view thirteen times slower; our logging is retained."""
    settings: Settings = app.state.settings
    doors = Doors(settings.max_connections, settings.max_connections_each, settings.trusted, settings.root)
    return uvicorn.Config(
        app,
        log_config=None,
        access_log=False,
        ws=bounded_socket(doors, settings.request_patience),
        ws_per_message_deflate=False,
        ws_max_size=LARGEST,
        http=bounded(doors, settings.request_patience, headers(settings.encrypted)),
        server_header=False,
        proxy_headers=False,  # uvicorn would believe every process of this machine; see `backend.middleware.proxy`
        backlog=ACCEPTED,
        timeout_keep_alive=IDLE,
        timeout_graceful_shutdown=GRACE,
    )


def _listen(settings: Settings) -> socket.socket:
    """Bind the socket before the announcement, so that an occupied port is reported in one sentence.

    The protocol is given explicitly, because asyncio sets TCP_NODELAY only on such sockets: headers and body of a
    response are two writes, and the second would wait 40 ms for the acknowledgement of the first.
    """
    family = socket.AF_INET6 if ":" in settings.host else socket.AF_INET
    listening = socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((settings.host, settings.port))
        listening.listen(128)
    except OSError as error:
        listening.close()
        where = f"{settings.host}:{settings.port}"
        raise OSError(f"cannot listen on {where}: {error.strerror}; choose another CLEARANCE_PORT") from None
    return listening


def _announce(app: FastAPI, settings: Settings, port: int) -> None:
    url = settings.url(port)
    (settings.data / OLD_LINK_FILE).unlink(missing_ok=True)
    write_private(settings.data / ADDRESS_FILE, url + "\n")
    if not settings.print_link:
        return
    with app.state.engine.begin() as connection:
        code = create_login_code(connection)
    print(f"Open {url}/login?code={code}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
