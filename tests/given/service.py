"""The service in its own thread on a free port, for tests over HTTP."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

import httpx
import sqlalchemy as sa
import uvicorn.server
from fastapi import FastAPI, routing
from starlette.routing import compile_path

from backend.__main__ import Server, _listen, server_config
from backend.access import routes
from backend.app import create
from backend.db import workers
from backend.db.access import create_login_code, create_token
from backend.db.tables import Base, CatalogueDocument, Worker
from backend.db.workers import SEEN
from backend.settings import Settings
from campaigns import Catalogue
from tests.given.code_versions import CODE, parts
from tests.given.small_catalogue import CATALOGUE


def until(condition: Callable[[], Any], seconds: float = 30.0) -> Any:
    """Wait for a condition, and fail when it does not come true in time; returns its value."""
    deadline = time.monotonic() + seconds
    while not (value := condition()):
        assert time.monotonic() < deadline, f"waited {seconds} s in vain"
        threading.Event().wait(0.01)
    return value


class _Hasty:
    """asyncio for uvicorn, which looks every 0.1 s whether it is to end and then waits 0.1 s: at a tenth of that."""

    def __getattr__(self, name: str) -> Any:
        return getattr(asyncio, name)

    async def sleep(self, delay: float) -> None:
        await asyncio.sleep(delay / 10)


workers.RESTART = 3600.0  # what `publish` has published is that of a worker, however long a test takes
uvicorn.server.asyncio = _Hasty()  # type: ignore[attr-defined]

# All applications have the same addresses.
routes.compile_path = cache(compile_path)  # type: ignore[attr-defined]

_ROUTERS: list[Any] = []
_DOCUMENTS: list[Any] = []

_CONTEXTS: dict[Any, Any] = {}
_context = routing._extract_endpoint_context


def _context_once(function: Any) -> Any:
    """Where a function is written, for messages of errors: FastAPI reads its file again for each application."""
    code = getattr(function, "__code__", function)
    if code not in _CONTEXTS:
        _CONTEXTS[code] = _context(function)
    return _CONTEXTS[code]


routing._extract_endpoint_context = _context_once  # type: ignore[assignment]


@cache
def _published() -> dict[str, Any]:
    """The small catalogue, as a worker would publish it."""
    document = CATALOGUE.model_dump(mode="json")
    return {"code": parts(document).model_dump(mode="json"), **document}


def share_routers(app: FastAPI) -> None:
    """Use the routers of the first application: FastAPI builds their routes at the first request, in 0.15 s, and they
    contain nothing of an application. So does the document that it derives from them, in 0.7 s."""
    derived = app.openapi

    def document() -> Any:
        if not _DOCUMENTS:
            _DOCUMENTS.append(derived())
        return _DOCUMENTS[0]

    app.openapi = document  # type: ignore[method-assign]
    mine = [at for at, route in enumerate(app.router.routes) if isinstance(route, routing._IncludedRouter)]
    if not _ROUTERS:
        _ROUTERS.extend(app.router.routes[at] for at in mine)
    for at, router in zip(mine, _ROUTERS, strict=True):
        app.router.routes[at] = router


class Service:
    """A running service: its address, its database, and visitors to it."""

    def __init__(self, settings: Settings, port: int = 0) -> None:
        """Start on a free port, or on the one that another service has left."""
        self.app = create(settings)
        share_routers(self.app)
        self.settings = settings
        self._socket = _listen(settings.model_copy(update={"port": port}))
        self.port = self._socket.getsockname()[1]
        self.url = f"http://127.0.0.1:{self.port}"
        self.server = Server(server_config(self.app))
        serving = lambda: asyncio.run(self.server.serve([self._socket]))  # noqa: E731
        self._thread = threading.Thread(target=serving, daemon=True)

    @property
    def engine(self) -> sa.Engine:
        engine = self.app.state.engine
        assert isinstance(engine, sa.Engine)
        return engine

    @property
    def running(self) -> bool:
        return self._thread.is_alive()

    def start(self) -> None:
        self._thread.start()
        until(lambda: self.server.started)

    def stop(self) -> None:
        self.server.should_exit = True
        self._thread.join(30)
        assert not self._thread.is_alive()
        self.engine.dispose()  # what a test has read in the meantime

    def publish(self, document: dict[str, Any] | None = None) -> None:
        """Have a catalogue, as a worker would publish it."""
        code = None if document is None else parts(document).model_dump(mode="json")
        document = _published() if document is None else {"code": code, **document}
        values = {"id": 1, "document": document, "published": time.time(), "code": CODE.digest}
        with self.engine.begin() as connection:
            connection.execute(sa.insert(CatalogueDocument).values(**values))

    def compare(self, at: float = 4e9) -> None:
        """Have a worker with the published simulators that compared its files with what is published at this time; it
        is alive for half a minute."""
        with self.engine.begin() as connection:
            document = connection.scalar(sa.select(CatalogueDocument.document))
            versions = [entry.version for entry in Catalogue.model_validate(document).simulators]
            times = {"started": time.time(), "beat": time.time() + SEEN / 2, "compared": at}
            connection.execute(sa.insert(Worker).values(name=f"w{at}", host="", pid=0, simulators=versions, **times))

    def login_code(self, lifetime: float = 60.0) -> str:
        with self.engine.begin() as connection:
            return create_login_code(connection, lifetime)

    def token(self, name: str = "ci") -> str:
        with self.engine.begin() as connection:
            return create_token(connection, name)

    @contextmanager
    def visitor(self, **headers: str) -> Iterator[httpx.Client]:
        """Someone who has not signed in."""
        # No certificate is checked over http, and reading those that might be takes 0.03 s.
        with httpx.Client(base_url=self.url, headers=headers, trust_env=False, verify=False, timeout=20) as client:
            yield client

    @contextmanager
    def signed_in(self) -> Iterator[httpx.Client]:
        """A browser that has opened the login link."""
        with self.visitor() as client:
            assert client.get("/login", params={"code": self.login_code()}).status_code == 303
            yield client

    def rows(self) -> dict[str, int]:
        """How many rows each table has."""
        with self.engine.connect() as connection:
            count = sa.func.count
            tables = Base.metadata.sorted_tables
            return {t.name: connection.scalar(sa.select(count()).select_from(t)) or 0 for t in tables}
