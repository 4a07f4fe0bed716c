"""The connection of this process to a cluster: made once, shared by its pools, made again when the scheduler dies.

A thread runs the event loop in which the client, the pools and the cluster of `local:N` live.
"""

from __future__ import annotations

import asyncio
import contextlib
import importlib.util
import logging
import threading
import time
from collections.abc import Callable, Coroutine
from typing import Any, TypeVar

import dask
from distributed import Client, LocalCluster, Security

from worker.engine.systems.simulators.cluster import node
from worker.engine.systems.simulators.cluster.address import Evaluator, EvaluatorLost

T = TypeVar("T")

log = logging.getLogger("clearance.cluster")

LOOK = 0.5
"""Interval at which the connection and the number of threads are looked at [s]."""
RETRY = 0.2
"""Between attempts to connect [s]."""
ATTEMPT = 5.0
"""Time for one attempt to connect [s]."""
END = 10.0
"""Time to close a connection, or a cluster on this machine [s]."""
PROMPT = 0.001
"""Least time between two messages of a stream [s]. Dask's own, 10 ms to the scheduler and 5 ms to a worker, delay a
task that follows the release of a result: one evaluation at a time took twice as long."""
CONFIGURED = {
    # A worker takes no task ahead: it would wait behind a long one while another worker is idle.
    "distributed.scheduler.worker-saturation": 1.0,
    # `pool` counts the deaths: the scheduler cannot distinguish the evaluation at fault from others of its task.
    "distributed.scheduler.allowed-failures": 0,
    "distributed.scheduler.http.routes": [],
    "distributed.worker.http.routes": [],
}
"""Of `local:N`."""


class Connection:
    """A client of a cluster in an event loop of its own; `acquire` returns it.

    changed: called in the loop whenever the number of threads has changed; lost: when the cluster counts as lost.
    """

    def __init__(self, evaluator: Evaluator) -> None:
        self.evaluator = evaluator
        self.threads = 0
        self.ahead = 0
        """Tasks that may wait at the scheduler, so that a worker that ends one has the next one at once."""
        self.users = 0
        self.changed: list[Callable[[], None]] = []
        self.lost: list[Callable[[EvaluatorLost], None]] = []
        self.keys: set[str] = set()
        """Of the pools, whose slots the nodes keep for as long as this process says so."""
        self._client: Client | None = None
        self._cluster: LocalCluster | None = None
        self._connecting = asyncio.Lock()
        self._failure: EvaluatorLost | None = None
        self._saturation = float("inf")
        for name in ("client", "comm", "nanny"):  # what matters is reported here
            logging.getLogger(f"distributed.{name}").setLevel(logging.CRITICAL)
        self.loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._run, name="cluster", daemon=True)
        self._thread.start()

    def call(self, work: Coroutine[Any, Any, T]) -> T:
        """Run a coroutine in the loop, from another thread."""
        return asyncio.run_coroutine_threadsafe(work, self.loop).result()

    async def client(self) -> Client:
        """A client that is connected; raises `EvaluatorLost` when there was none for the stated patience."""
        async with self._connecting:
            if self._failure is not None:
                raise self._failure
            if self.connected is not None:
                return self.connected
            if self._client is not None:
                log.warning("%s: the connection to the scheduler was lost; connecting again", self.evaluator.address)
            try:
                await self._forget()
                return await self._connected(time.monotonic() + self.evaluator.patience)
            except EvaluatorLost as error:
                self._failure = error
                raise

    @property
    def connected(self) -> Client | None:
        """The client, if it is connected now."""
        return self._client if self._client is not None and self._client.status == "running" else None

    def close(self) -> None:
        with contextlib.suppress(Exception):
            self.call(asyncio.wait_for(self._end(), 2 * END))
        self.loop.call_soon_threadsafe(self.loop.stop)
        self._thread.join()

    def _run(self) -> None:
        asyncio.set_event_loop(self.loop)
        _tasks = [self.loop.create_task(work) for work in (self._watch(), self._keep())]  # the loop would not hold them
        try:
            self.loop.run_forever()
        finally:
            left = asyncio.all_tasks(self.loop)
            for task in left:
                task.cancel()
            self.loop.run_until_complete(asyncio.gather(*left, return_exceptions=True))
            self.loop.run_until_complete(self.loop.shutdown_asyncgens())
            self.loop.close()

    async def _connected(self, deadline: float) -> Client:
        self._check_certificates()
        address: Any = self.evaluator.scheduler or await self._local()
        while True:
            try:
                return await self._attempt(address, deadline)
            except EvaluatorLost:
                raise
            except Exception as error:  # it may die at any moment, in whatever this process was doing with it
                await self._forget()
                if time.monotonic() > deadline:
                    why = f"{_short(error)}; check that it runs"
                    raise self._lost("its scheduler could not be reached", why) from None
            await asyncio.sleep(RETRY)

    async def _attempt(self, address: Any, deadline: float) -> Client:
        """Connect once, then wait for a worker."""
        timeout = max(0.1, min(ATTEMPT, deadline - time.monotonic()))
        direct = bool(self.evaluator.processes)
        client = self._client = await Client(
            address, asynchronous=True, timeout=timeout, set_as_default=False, direct_to_workers=direct
        )
        await self._look_around(client, deadline)
        return client

    def _check_certificates(self) -> None:
        """TLS needs those of a client, from the configuration of Dask."""
        if not self.evaluator.scheduler.startswith("tls:"):
            return
        try:
            if Security().get_connection_args("client")["ssl_context"] is not None:
                return
            why = "none are configured"
        except OSError as error:  # no such file, or it contains something else
            why = _short(error)
        raise EvaluatorLost(
            f"evaluator {self.evaluator.address}: TLS needs certificates of the client: {why}; set "
            "DASK_DISTRIBUTED__COMM__TLS__CA_FILE, and CLIENT__CERT and CLIENT__KEY in place of CA_FILE"
        )

    async def _look_around(self, client: Client, deadline: float) -> None:
        """Read the state of the scheduler and its first worker."""
        try:
            self._saturation = await asyncio.wait_for(client.run_on_scheduler(node.saturation), ATTEMPT)
        except (ImportError, AttributeError) as error:
            raise EvaluatorLost(
                f"evaluator {self.evaluator.address}: its scheduler cannot load this version of Clearance ({error}): "
                "install the same one on the scheduler's node and on all workers"
            ) from None
        while not await self._count(client):
            if time.monotonic() > deadline:
                raise self._lost("it had no worker", "start some, or state a longer patience such as ?patience=3600")
            await asyncio.sleep(RETRY)

    async def _count(self, client: Client) -> int:
        """The number of threads now."""
        self._speed_up(client)
        threads: int = sum((await asyncio.wait_for(client.nthreads(), ATTEMPT)).values())
        if threads != self.threads:
            self.threads = threads
            self.ahead = threads if self._saturation <= 1.0 else 0
            for changed in self.changed:
                changed()
        return threads

    def _speed_up(self, client: Client) -> None:
        """Send messages soon, also those of our own scheduler; a stream without such a setting stays as it is."""
        streams = [getattr(client, "scheduler_comm", None)]
        if self._cluster is not None:
            streams += getattr(self._cluster.scheduler, "stream_comms", {}).values()
        for stream in streams:
            if stream is not None and hasattr(stream, "interval"):
                stream.interval = PROMPT

    async def _watch(self) -> None:
        """Notice that the scheduler died, or all workers left, while nothing else would."""
        since = time.monotonic()
        while True:
            await asyncio.sleep(LOOK)
            if self._client is None or self._connecting.locked():
                since = time.monotonic()
                continue
            try:
                client = await self.client()
                if await self._count(client):
                    since = time.monotonic()
            except EvaluatorLost as error:
                self._give_up(error)
                return
            except Exception as error:
                log.warning("%s: %s", self.evaluator.address, _short(error))
            if time.monotonic() - since > self.evaluator.patience:
                why = "all that it had have ended; see their logs (one without this version of Clearance ends at once)"
                self._failure = self._lost("it had no worker", why)
                self._give_up(self._failure)
                return

    async def _keep(self) -> None:
        while True:
            await asyncio.sleep(node.KEEP)
            if self.connected is not None and self.keys:
                with contextlib.suppress(Exception):  # a node that is lost is noticed elsewhere
                    kept = self.connected.run(node.keep, sorted(self.keys), on_error="ignore")
                    await asyncio.wait_for(kept, ATTEMPT)

    def _give_up(self, error: EvaluatorLost) -> None:
        for lost in list(self.lost):
            lost(error)

    async def _local(self) -> LocalCluster:
        """The cluster on this machine, on ports of the loopback interface that the system chooses."""
        if self._cluster is None:
            try:
                with dask.config.set(CONFIGURED):
                    self._cluster = await LocalCluster(
                        n_workers=self.evaluator.processes, threads_per_worker=1, processes=True, asynchronous=True,
                        host="127.0.0.1", memory_limit=None, preload=node.__name__,
                        scheduler_kwargs={"dashboard": False, "dashboard_address": "127.0.0.1:0"},
                        security=True if importlib.util.find_spec("cryptography") else None,
                    )  # fmt: skip
            except Exception as error:
                why = f"its processes could not be started: {_short(error)}"
                raise EvaluatorLost(f"evaluator {self.evaluator.address}: {why}") from error
        return self._cluster

    async def _forget(self) -> None:
        client, self._client = self._client, None
        if client is not None:
            with contextlib.suppress(Exception):
                await asyncio.wait_for(client.close(timeout=1), END)

    async def _end(self) -> None:
        await self._forget()
        if self._cluster is not None:
            await self._cluster.close(timeout=END)

    def _lost(self, what: str, why: str) -> EvaluatorLost:
        return EvaluatorLost(f"evaluator {self.evaluator.address}: {what} for {self.evaluator.patience:g} s: {why}")


def _short(error: BaseException) -> str:
    return " ".join(str(error).split())[:200] or type(error).__name__


_lock = threading.Lock()
_shared: dict[str, Connection] = {}


def acquire(evaluator: Evaluator) -> Connection:
    """The connection of this process to an evaluator; every call needs a `release`."""
    with _lock:
        connection = _shared.get(evaluator.address)
        if connection is None:
            connection = _shared[evaluator.address] = Connection(evaluator)
        connection.users += 1
        return connection


def release(connection: Connection) -> None:
    """Close a connection that is no longer used."""
    with _lock:
        connection.users -= 1
        if connection.users:
            return
        _shared.pop(connection.evaluator.address, None)
    connection.close()
