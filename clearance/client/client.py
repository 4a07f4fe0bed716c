"""`Client` and `AsyncClient`: a Clearance service from Python. Both have the methods of `_Methods`.

A method is a script or a request; its descriptor has it run, blocking or awaited, so that nothing is written twice.
"""

from __future__ import annotations

import functools
import os
from collections.abc import AsyncGenerator, Awaitable, Callable, Iterator
from typing import Any, Concatenate, Generic, ParamSpec, Self, TypeVar, overload

import httpx

from clearance.client import calls, scripts
from clearance.client.drivers import Awaiting, Blocking, each, finished, settings
from clearance.client.scripts import Script, asking
from clearance.client.session import Session

P = ParamSpec("P")
T = TypeVar("T")
A = TypeVar("A")
SERVICE = "http://127.0.0.1:8000"
PATIENCE = 120.0
"""How long to repeat a request while the service does not respond [s]."""


class _Method(Generic[P, T, A]):
    """A script as a method: what it returns in a blocking client, and what in the other."""

    def __init__(self, script: Callable[..., Any], run: str) -> None:
        self.script, self.run = script, run
        self.__doc__ = script.__doc__

    @overload
    def __get__(self, client: Client, kind: object = None) -> Callable[P, T]: ...

    @overload
    def __get__(self, client: AsyncClient, kind: object = None) -> Callable[P, A]: ...

    def __get__(self, client: Any, kind: object = None) -> Any:
        if client is None:
            return self

        @functools.wraps(self.script)
        def method(*positional: Any, **named: Any) -> Any:
            return getattr(client, self.run)(self.script(client.session, *positional, **named))

        return method


def _method(script: Callable[Concatenate[Session, P], Script[T]]) -> _Method[P, T, Awaitable[T]]:
    return _Method(script, "_finished")


def _iterated(
    script: Callable[Concatenate[Session, P], AsyncGenerator[T]],
) -> _Method[P, Iterator[T], AsyncGenerator[T]]:
    """One that hands out values one by one."""
    return _Method(script, "_each")


class _Methods:
    """What both clients have."""

    session: Session
    _finished: Callable[[Any], Any]
    """How a script is run, and one that hands out values."""
    _each: Callable[[Any], Any]
    _library: Callable[..., Any]
    """The client of httpx, and what has it send."""
    _driver: Callable[[Any], Blocking | Awaiting]

    def __init__(
        self, url: str | None = None, token: str | None = None, *, patience: float = PATIENCE, **how: Any
    ) -> None:
        """Address and token are from the environment if they are not stated; `ValueError` for a patience of nan."""
        if not patience >= 0.0:  # nan would never run out
            raise ValueError(f"patience is {patience}; give 0 or more seconds")
        address = str(url or os.environ.get("CLEARANCE_SERVICE") or SERVICE).rstrip("/")
        secret = (os.environ.get("CLEARANCE_TOKEN", "") if token is None else token).strip()
        self._http = self._library(**settings(address, secret, how))
        self.session = Session(address, patience, self._driver(self._http))

    @property
    def address(self) -> str:
        """The address of the service."""
        return self.session.address

    def link(self, run: calls.Named) -> str:
        """The page of a run."""
        return f"{self.address}/runs/{calls.name_of(run)}"

    submit = _method(asking(calls.submit))
    search = _method(scripts.search)
    wait = _method(scripts.wait)
    follow = _iterated(scripts.follow)
    run = _method(asking(calls.run))
    runs = _iterated(scripts.runs)
    run_page = _method(asking(calls.run_page))
    cancel = _method(asking(calls.cancel))
    retry = _method(asking(calls.retry))
    restart = _method(asking(calls.restart))
    carry_on = _method(asking(calls.carry_on))
    findings = _method(scripts.findings)
    most_likely_violation = _method(asking(calls.most_likely_violation))
    evaluations = _method(scripts.evaluations)
    signoffs = _method(asking(calls.signoffs))
    traces = _method(asking(calls.traces))
    trace = _method(scripts.trace)
    exports = _method(asking(calls.exports))
    export = _method(scripts.export)
    report = _method(scripts.report)
    picture = _method(scripts.picture)
    campaign_text = _method(scripts.campaign_text)
    sweep = _method(asking(calls.sweep))
    read_sweep = _method(asking(calls.read_sweep))
    wait_sweep = _method(scripts.wait_sweep)
    follow_sweep = _iterated(scripts.follow_sweep)
    cancel_sweep = _method(asking(calls.cancel_sweep))
    export_sweep = _method(scripts.export_sweep)
    check = _method(asking(calls.check))
    schema = _method(asking(calls.schema))
    health = _method(asking(calls.health))


class Client(_Methods):
    """A Clearance service.

    url: its address; by default CLEARANCE_SERVICE, else http://127.0.0.1:8000. token: an API token (`clearance token
    create NAME`); by default CLEARANCE_TOKEN. patience: how long to repeat a request while the service does not respond
    or is busy [s]. Further arguments are those of `httpx.Client`, such as `verify`. Raises `InvalidAddressError`.

    Every method raises `RefusedError` (one of its classes) with the service's sentence if the service refuses the
    request, and `UnreachableError` if it does not respond in time.
    """

    _library, _driver = httpx.Client, Blocking
    _finished, _each = staticmethod(finished), staticmethod(each)

    def close(self) -> None:
        """Close the connections of the client."""
        self._http.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class AsyncClient(_Methods):
    """The same as `Client` with `await`, and `async for` over `follow`, `runs` and `follow_sweep`.

    Further arguments are those of `httpx.AsyncClient`.
    """

    _library, _driver = httpx.AsyncClient, Awaiting
    _finished = _each = staticmethod(lambda script: script)

    async def close(self) -> None:
        """Close the connections of the client."""
        await self._http.aclose()

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()
