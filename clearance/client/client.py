"""`Client` and `AsyncClient`: a Clearance service from Python. Both have the same methods, run from the same scripts.

A method is a script or a request; the descriptors here run it, blocking or awaited, so that nothing is written twice.
"""

from __future__ import annotations

import functools
import os
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from typing import Any, Concatenate, Generic, ParamSpec, Self, TypeVar

from clearance.client import answers, calls, scripts
from clearance.client.drivers import Awaiting, Blocking
from clearance.client.effects import Script, Session
from clearance.client.scripts import asking

P = ParamSpec("P")
T = TypeVar("T")
SERVICE = "http://127.0.0.1:8000"
PATIENCE = 120.0
"""How long to repeat a request while the service does not respond [s]."""


class _Method(Generic[P, T]):
    """A script as a method of a client."""

    def __init__(self, script: Callable[Concatenate[Session, P], Script[Any]], emits: type[T] | None = None) -> None:
        """emits: the type of what it hands out one by one; None for a script with one result."""
        self.script, self.emits = script, emits
        self.__doc__ = script.__doc__

    def of(self, client: Client | AsyncClient | None) -> Any:
        """The method of a client; of the class: this."""
        if client is None:
            return self
        driver = client.driver
        run: Callable[[Script[Any]], Any] = driver.run if self.emits is None else driver.iterate

        @functools.wraps(self.script)
        def method(*given: P.args, **named: P.kwargs) -> Any:
            return run(self.script(client.session, *given, **named))

        return method


class _Blocking(_Method[P, T]):
    def __init__(self, script: Callable[Concatenate[Session, P], Script[T]]) -> None:
        super().__init__(script)

    def __get__(self, client: Client | None, _: object = None) -> Callable[P, T]:
        return self.of(client)  # type: ignore[no-any-return]


class _Awaited(_Method[P, T]):
    def __init__(self, script: Callable[Concatenate[Session, P], Script[T]]) -> None:
        super().__init__(script)

    def __get__(self, client: AsyncClient | None, _: object = None) -> Callable[P, Awaitable[T]]:
        return self.of(client)  # type: ignore[no-any-return]


class _Iterated(_Method[P, T]):
    def __get__(self, client: Client | None, _: object = None) -> Callable[P, Iterator[T]]:
        return self.of(client)  # type: ignore[no-any-return]


class _AwaitedInTurn(_Method[P, T]):
    def __get__(self, client: AsyncClient | None, _: object = None) -> Callable[P, AsyncIterator[T]]:
        return self.of(client)  # type: ignore[no-any-return]


def _given(url: str | None, token: str | None) -> tuple[str, str]:
    """Address and token, from the environment where they are not given."""
    address = url or os.environ.get("CLEARANCE_SERVICE") or SERVICE
    return address.rstrip("/"), (os.environ.get("CLEARANCE_TOKEN", "") if token is None else token).strip()


class Client:
    """A Clearance service.

    url: its address; by default CLEARANCE_SERVICE, else http://127.0.0.1:8000. token: an API token (`clearance token
    create NAME`); by default CLEARANCE_TOKEN. patience: how long to repeat a request while the service does not respond
    or is busy [s]. Further arguments are those of `httpx.Client`, such as `verify`. Raises `InvalidAddressError`.

    Every method raises `RefusedError` (one of its classes) with the service's sentence if the service refuses the
    request, and `UnreachableError` if it does not respond in time.
    """

    def __init__(
        self, url: str | None = None, token: str | None = None, *, patience: float = PATIENCE, **how: Any
    ) -> None:
        address, secret = _given(url, token)
        self.session = Session(address, patience)
        self.driver = Blocking(address, secret, **how)

    @property
    def address(self) -> str:
        """The address of the service."""
        return self.session.address

    def link(self, run: calls.Named) -> str:
        """The page of a run."""
        return f"{self.address}/runs/{calls.name_of(run)}"

    def close(self) -> None:
        """Close the connections of the client."""
        self.driver.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    submit = _Blocking(asking(calls.submit))
    search = _Blocking(scripts.search)
    wait = _Blocking(scripts.wait)
    follow = _Iterated(scripts.follow, answers.Run)
    run = _Blocking(asking(calls.run))
    runs = _Iterated(scripts.runs, answers.Run)
    run_page = _Blocking(asking(calls.run_page))
    cancel = _Blocking(asking(calls.cancel))
    restart = _Blocking(asking(calls.restart))
    carry_on = _Blocking(asking(calls.carry_on))
    findings = _Blocking(scripts.findings)
    evaluations = _Blocking(scripts.evaluations)
    traces = _Blocking(asking(calls.traces))
    trace = _Blocking(scripts.trace)
    exports = _Blocking(asking(calls.exports))
    export = _Blocking(scripts.export)
    report = _Blocking(scripts.report)
    picture = _Blocking(scripts.picture)
    campaign_text = _Blocking(scripts.campaign_text)
    sweep = _Blocking(asking(calls.sweep))
    read_sweep = _Blocking(asking(calls.read_sweep))
    wait_sweep = _Blocking(scripts.wait_sweep)
    follow_sweep = _Iterated(scripts.wait_sweep, answers.Sweep)
    cancel_sweep = _Blocking(asking(calls.cancel_sweep))
    export_sweep = _Blocking(scripts.export_sweep)
    check = _Blocking(asking(calls.check))
    schema = _Blocking(asking(calls.schema))
    health = _Blocking(asking(calls.health))


class AsyncClient:
    """The same as `Client` with `await`, and `async for` over `follow`, `runs` and `follow_sweep`.

    Further arguments are those of `httpx.AsyncClient`.
    """

    def __init__(
        self, url: str | None = None, token: str | None = None, *, patience: float = PATIENCE, **how: Any
    ) -> None:
        address, secret = _given(url, token)
        self.session = Session(address, patience)
        self.driver = Awaiting(address, secret, **how)

    @property
    def address(self) -> str:
        """The address of the service."""
        return self.session.address

    def link(self, run: calls.Named) -> str:
        """The page of a run."""
        return f"{self.address}/runs/{calls.name_of(run)}"

    async def close(self) -> None:
        """Close the connections of the client."""
        await self.driver.close()

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    submit = _Awaited(asking(calls.submit))
    search = _Awaited(scripts.search)
    wait = _Awaited(scripts.wait)
    follow = _AwaitedInTurn(scripts.follow, answers.Run)
    run = _Awaited(asking(calls.run))
    runs = _AwaitedInTurn(scripts.runs, answers.Run)
    run_page = _Awaited(asking(calls.run_page))
    cancel = _Awaited(asking(calls.cancel))
    restart = _Awaited(asking(calls.restart))
    carry_on = _Awaited(asking(calls.carry_on))
    findings = _Awaited(scripts.findings)
    evaluations = _Awaited(scripts.evaluations)
    traces = _Awaited(asking(calls.traces))
    trace = _Awaited(scripts.trace)
    exports = _Awaited(asking(calls.exports))
    export = _Awaited(scripts.export)
    report = _Awaited(scripts.report)
    picture = _Awaited(scripts.picture)
    campaign_text = _Awaited(scripts.campaign_text)
    sweep = _Awaited(asking(calls.sweep))
    read_sweep = _Awaited(asking(calls.read_sweep))
    wait_sweep = _Awaited(scripts.wait_sweep)
    follow_sweep = _AwaitedInTurn(scripts.wait_sweep, answers.Sweep)
    cancel_sweep = _Awaited(asking(calls.cancel_sweep))
    export_sweep = _Awaited(scripts.export_sweep)
    check = _Awaited(asking(calls.check))
    schema = _Awaited(asking(calls.schema))
    health = _Awaited(asking(calls.health))
