"""`clearance serve`: the service and its workers on this machine, until Ctrl-C."""

from __future__ import annotations

import errno
import os
import signal
import socket
import sys
import time
import urllib.request
from pathlib import Path
from typing import Annotated

import typer

from backend import secret_settings
from backend.db.availability import awaited, sentence
from backend.db.engine import connected
from backend.db.private import keep_private
from clearance.cli import INTERNAL, INTERRUPTED, WRONG_INPUT, WrongInputError, on_disk, refusing
from clearance.cli._where import DATA, Data, Database, alone, counted, reading, url_of
from clearance.cli.login_link import ADDRESS_FILE
from clearance.cli.worker import DRAINED
from worker.engine.kernels import jit
from worker.engine.systems.threads import usual_threads
from worker.running.processes import memory
from worker.running.processes.lifeline import Wakeup
from worker.running.processes.serving import Server, Servers

PATIENCE = 300.0
"""How long the service may take to start, and after which it does not wait for a worker any more [s]."""

MISSING = "The service is ready, and runs nothing until a worker has started"

UNUSABLE_SETTINGS = 2
"""The exit code of a backend that cannot start because of its settings."""

_DIRECT = urllib.request.build_opener(urllib.request.ProxyHandler({}))
"""Connects directly to this machine, ignoring any proxy of the environment."""


def serve(
    host: Annotated[str, typer.Option(help="Address to listen on.", envvar="CLEARANCE_HOST")] = "127.0.0.1",
    port: Annotated[
        int, typer.Option(help="0 selects any free port.", min=0, max=65535, envvar="CLEARANCE_PORT")
    ] = 8000,
    data: Data = DATA,
    database: Database = "",
    number: Annotated[
        int,
        typer.Option(
            "--workers",
            help="Maximum number of runs at the same time; one without a run simulates blocks of another's large "
            "sample.",
            min=0,
            max=256,
        ),
    ] = 1,
) -> None:
    """Start the service and its workers, print a login link, and stop everything on Ctrl-C."""
    jit.refuse(jit.by_environment())
    with refusing(ValueError):
        memory.refuse()
    if not data.exists():
        _reserved(host, port).close()  # before anything is made
    with on_disk(f"the folder {data} cannot be used"):
        keep_private(data, database)
    url = url_of(data, database)
    with alone(data, url), _reserved(host, port) as reserved:
        port = reserved.getsockname()[1]
        if away := awaited(url):
            typer.echo(f"The service and its workers start, {sentence(away)}")
        with Wakeup() as wakeup:
            code = _Serving(host, port, data.absolute(), url, number, wakeup).run()
    raise typer.Exit(code)


class _Serving:
    """One `serve`: start, wait until healthy, print the link, watch, stop."""

    def __init__(self, host: str, port: int, data: Path, url: str, number: int, wakeup: Wakeup) -> None:
        self.address = f"http://{f'[{host}]' if ':' in host else host}:{port}"
        self.data, self.url, self.wakeup = data, url, wakeup
        here = {
            "CLEARANCE_DATA": str(data),
            "CLEARANCE_DATABASE": url,
            "PYTHONUNBUFFERED": "1",
            **secret_settings.WHOLE,
        }
        if number > 1:  # each would otherwise take every core
            here["CLEARANCE_THREADS"] = os.environ.get("CLEARANCE_THREADS") or str(max(1, usual_threads() // number))
        # Its output is a log: the link is printed here, by `_welcome`.
        listen = {**here, "CLEARANCE_HOST": host, "CLEARANCE_PORT": str(port), "CLEARANCE_PRINT_LINK": "false"}
        python = [sys.executable, "-P", "-m"]
        logs = data / "logs"
        self.backend = Server("The backend", [*python, "backend"], listen, logs / "backend.log", signal.SIGKILL)
        # A worker that loses its parent still returns its run to the queue; its child processes die with it.
        worker = [*python, "clearance", "worker"]
        self.workers = [
            Server(f"Worker {i}", worker, here, logs / f"worker-{i}.log", signal.SIGTERM, final=DRAINED)
            for i in range(1, number + 1)
        ]
        self.servers = Servers([self.backend, *self.workers], wakeup, typer.echo)

    def run(self) -> int:
        """Returns the exit code."""
        typer.echo(f"Starting the service and {counted(len(self.workers), 'worker')} on {self.data} ...")
        begun = time.time()
        self.servers.start()
        try:
            code = self._wait_until_healthy(begun)
            if code is None:
                for sentence in self.backend.warnings():
                    typer.echo(f"Warning: {sentence}")
                self._welcome(begun)
                while self.wakeup.signal is None:
                    self.servers.watch(1.0)
                code = self._interrupted()
            return code
        finally:
            typer.echo("Stopping ...")
            self.servers.stop()
            typer.echo("Stopped.")

    def _wait_until_healthy(self, begun: float) -> int | None:
        """None once the backend answers, and a worker has published its catalogue or is late; an exit code if the
        backend fails."""
        deadline = time.monotonic() + PATIENCE
        healthy = offered = False
        while not (healthy and offered):
            if self.backend in self.servers.watch(0.1):
                typer.echo("The service could not start; see its messages above.")
                return WRONG_INPUT if self.backend.status == UNUSABLE_SETTINGS else INTERNAL
            if self.wakeup.signal is not None:
                return self._interrupted()
            if time.monotonic() > deadline:
                late = self.workers[0] if healthy else self.backend
                who = "No worker has" if healthy else "The backend has not"
                typer.echo(f"{who} started within {PATIENCE:g} s. From {late.log}:\n{late.tail()}")
                return None if healthy else INTERNAL  # workers are started again while the service runs
            healthy = healthy or _answers(f"{self.address}/api/v1/health")
            if not healthy and _answers(f"{self.address}/api/v1/health/live"):  # it waits for the database
                deadline = time.monotonic() + PATIENCE
            offered = healthy and (offered or not self.workers or self._published() >= begun)
        return None

    def _published(self) -> float:
        from backend.db import workers

        with reading(self.url) as connection:
            return workers.published(connection) or 0.0

    def _welcome(self, begun: float) -> None:
        from backend.db import access

        with connected(self.url) as engine, engine.begin() as connection:
            code = access.create_login_code(connection)
        link = f"{(self.data / ADDRESS_FILE).read_text().strip()}/login?code={code}"
        missing = bool(self.workers) and self._published() < begun
        ready = MISSING if missing else "Clearance is ready"
        typer.echo(f"\n{ready}. Open this link to log in (it can be used once, within 15 minutes):\n")
        typer.echo(f"    {link}\n")
        typer.echo("For a new link: clearance login-link. To stop: Ctrl-C.")

    def _interrupted(self) -> int:
        return INTERRUPTED if self.wakeup.signal == signal.SIGINT else 0


def _reserved(host: str, port: int) -> socket.socket:
    """A socket at the port, or at a free one for 0; `WrongInputError` if it is not available.

    While it is open, the system gives the port to no process that requests any free one; the backend can listen on it,
    as it reuses addresses, too."""
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        probe = socket.socket(family, kind, protocol)
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(address)
        except OSError:
            probe.close()
            raise
        return probe
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            hint = (
                f"port {port} of {host} is in use by another program; choose another with --port, or 0 for any free one"
            )
        else:
            hint = f"cannot listen on {host}:{port}: {error.strerror}"
        raise WrongInputError(hint) from None


def _answers(url: str) -> bool:
    try:
        with _DIRECT.open(url, timeout=2.0) as response:
            return bool(response.status == 200)
    except OSError:
        return False
