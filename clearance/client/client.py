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
SERVICE = "http://127.0.0.1:8000"
PATIENCE = 120.0
"""How long to repeat a request while the service does not respond [s]."""


class _Method(Generic[P, T]):
    """A script as a method of a client."""

    def __init__(self, script: Callable[Concatenate[Session, P], Script[T]]) -> None:
        self.script = script
        self.__doc__ = script.__doc__

    @overload
    def __get__(self, client: Client, kind: object = None) -> Callable[P, T]: ...

    @overload
    def __get__(self, client: AsyncClient, kind: object = None) -> Callable[P, Awaitable[T]]: ...

    def __get__(self, client: Any, kind: object = None) -> Any:
        return self if client is None else _run_by(client, client._finished, self.script)


class _Iterated(Generic[P, T]):
    """A script as a method of a client that hands out values one by one."""

    def __init__(self, script: Callable[Concatenate[Session, P], AsyncGenerator[T]]) -> None:
        self.script = script
        self.__doc__ = script.__doc__

    @overload
    def __get__(self, client: Client, kind: object = None) -> Callable[P, Iterator[T]]: ...

    @overload
    def __get__(self, client: AsyncClient, kind: object = None) -> Callable[P, AsyncGenerator[T]]: ...

    def __get__(self, client: Any, kind: object = None) -> Any:
        return self if client is None else _run_by(client, client._each, self.script)


def _run_by(client: _Methods, run: Callable[[Any], Any], script: Callable[..., Any]) -> Any:
    @functools.wraps(script)
    def method(*positional: Any, **named: Any) -> Any:
        return run(script(client.session, *positional, **named))

    return method


class _Methods:
    """What both clients have."""

    session: Session
    _finished: Callable[[Any], Any]
    """How a script is run, and one that hands out values."""
    _each: Callable[[Any], Any]

    @property
    def address(self) -> str:
        """The address of the service."""
        return self.session.address

    def link(self, run: calls.Named) -> str:
        """The page of a run."""
        return f"{self.address}/runs/{calls.name_of(run)}"

    submit = _Method(asking(calls.submit))
    search = _Method(scripts.search)
    wait = _Method(scripts.wait)
    follow = _Iterated(scripts.follow)
    run = _Method(asking(calls.run))
    runs = _Iterated(scripts.runs)
    run_page = _Method(asking(calls.run_page))
    cancel = _Method(asking(calls.cancel))
    retry = _Method(asking(calls.retry))
    restart = _Method(asking(calls.restart))
    carry_on = _Method(asking(calls.carry_on))
    findings = _Method(scripts.findings)
    most_likely_violation = _Method(asking(calls.most_likely_violation))
    evaluations = _Method(scripts.evaluations)
    signoffs = _Method(asking(calls.signoffs))
    traces = _Method(asking(calls.traces))
    trace = _Method(scripts.trace)
    exports = _Method(asking(calls.exports))
    export = _Method(scripts.export)
    report = _Method(scripts.report)
    picture = _Method(scripts.picture)
    campaign_text = _Method(scripts.campaign_text)
    sweep = _Method(asking(calls.sweep))
    read_sweep = _Method(asking(calls.read_sweep))
    wait_sweep = _Method(scripts.wait_sweep)
    follow_sweep = _Iterated(scripts.follow_sweep)
    cancel_sweep = _Method(asking(calls.cancel_sweep))
    export_sweep = _Method(scripts.export_sweep)
    check = _Method(asking(calls.check))
    schema = _Method(asking(calls.schema))
    health = _Method(asking(calls.health))


def _settings(url: str | None, token: str | None, patience: float) -> tuple[str, str]:
    """Address and token, from the environment where they are not stated; raises `ValueError` for a patience of nan."""
    if not patience >= 0.0:  # nan would never run out
        raise ValueError(f"patience is {patience}; give 0 or more seconds")
    address = str(url or os.environ.get("CLEARANCE_SERVICE") or SERVICE)
    return address.rstrip("/"), (os.environ.get("CLEARANCE_TOKEN", "") if token is None else token).strip()


class Client(_Methods):
    """A Clearance service.

    url: its address; by default CLEARANCE_SERVICE, else http://127.0.0.1:8000. token: an API token (`clearance token
    create NAME`); by default CLEARANCE_TOKEN. patience: how long to repeat a request while the service does not respond
    or is busy [s]. Further arguments are those of `httpx.Client`, such as `verify`. Raises `InvalidAddressError`.

    Every method raises `RefusedError` (one of its classes) with the service's sentence if the service refuses the
    request, and `UnreachableError` if it does not respond in time.
    """

    _finished, _each = staticmethod(finished), staticmethod(each)

    def __init__(
        self, url: str | None = None, token: str | None = None, *, patience: float = PATIENCE, **how: Any
    ) -> None:
        address, secret = _settings(url, token, patience)
        self._http = httpx.Client(**settings(address, secret, how))
        self.session = Session(address, patience, Blocking(self._http))

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

    _finished = _each = staticmethod(lambda script: script)

    def __init__(
        self, url: str | None = None, token: str | None = None, *, patience: float = PATIENCE, **how: Any
    ) -> None:
        address, secret = _settings(url, token, patience)
        self._http = httpx.AsyncClient(**settings(address, secret, how))
        self.session = Session(address, patience, Awaiting(self._http))

    async def close(self) -> None:
        """Close the connections of the client."""
        await self._http.aclose()

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()
