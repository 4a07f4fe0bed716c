"""The service is killed, stopped or restarted while a run goes on and a client posts further ones."""

from __future__ import annotations

import signal
import socket
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import httpx
import sqlalchemy as sa

from backend.db.engine import read
from backend.db.tables import Run
from tests.faults.processes import Started, kill, started, until
from tests.storm.faults.base import MIDDLE, Fault, Hurt
from tests.storm.faults.databases import AWAY
from tests.storm.site import Site, campaign

POSTED = 3
"""Runs that a client posts while the service is hurt."""
PAUSE = 0.3


class Service:
    """`python -m backend` on the site's database, started again on the same port by whoever hurts it."""

    def __init__(self, site: Site) -> None:
        self.site, self.port, self.number = site, _free_port(), 0
        self.running = self.start()
        client = httpx.Client(base_url=self.running.address(), trust_env=False, timeout=20)
        self.client = site.stack.enter_context(client)
        assert self.client.get(self.running.link()).status_code == 303

    def start(self) -> Started:
        """Once it answers."""
        self.number += 1
        data = self.site.folder / "service"
        data.mkdir(exist_ok=True)
        (data / "pages").mkdir(exist_ok=True)
        (data / "pages" / "index.html").touch()
        own = {"DATA": str(data), "DATABASE": self.site.url, "PORT": self.port, "PAGES": str(data / "pages")}
        environment = self.site.environment | {f"CLEARANCE_{name}": value for name, value in own.items()}
        command, name = [sys.executable, "-m", "backend"], f"service{self.number}"
        self.running = self.site.stack.enter_context(started(command, self.site.folder, name, **environment))
        until(self.running.link, "the service is there", 60)
        return self.running

    def post(self, name: str) -> str | None:
        """Submit a run of the slow program; None if it is not known whether there is one."""
        document = {key: value for key, value in campaign(1, "slots").document().items() if key != "baseline"}
        try:
            answer = self.client.post("/api/v1/runs", json={"campaign": document, "name": name})
        except httpx.TransportError:
            return None
        assert answer.status_code in (201, 503), answer.text
        return str(answer.json()["id"]) if answer.status_code == 201 else None


def _free_port() -> str:
    """Stated from the beginning, as the name of the session's cookie has it."""
    with socket.create_server(("127.0.0.1", 0)) as bound:
        return str(bound.getsockname()[1])


@contextmanager
def posting(service: Service) -> Iterator[list[str]]:
    """A client posts runs until so many were accepted, while the block lasts and after it."""
    accepted: list[str] = []
    over = threading.Event()

    def post() -> None:
        attempt = 0
        while len(accepted) < POSTED and not over.wait(PAUSE):
            attempt += 1
            if service.post(f"posted {attempt}") is not None:
                accepted.append(f"posted {attempt}")

    client = threading.Thread(target=post, daemon=True)
    client.start()
    try:
        yield accepted
        until(lambda: len(accepted) == POSTED, "its runs are accepted", 60)
    finally:
        over.set()
        client.join()


def served(then: Callable[[Site, Started, Service], None]) -> Hurt:
    """What happens to a service, its client and the worker; every run that was accepted is there once."""

    def serve(site: Site, worker: Started) -> None:
        service = Service(site)
        with posting(service) as accepted:
            until(lambda: len(accepted) > 0, "the first one is accepted", 60)
            then(site, worker, service)
        with read(site.engine) as connection:
            names = list(connection.scalars(sa.select(Run.name).where(Run.name.startswith("posted"))))
        assert sorted(accepted) == sorted(name for name in names if name in accepted)
        assert len(names) == len(set(names))
        site.seen = f"{len(accepted)} posted runs were accepted and are there once"
        kill(service.running.pid, number=signal.SIGTERM)
        until(lambda: service.running.process.poll() is not None, "the service ends", 20)

    return serve


def again(number: signal.Signals) -> Hurt:
    def end(site: Site, worker: Started, service: Service) -> None:
        kill(service.running.pid, number=number)
        until(lambda: service.running.process.poll() is not None, "it ends", 20)
        service.start()

    return served(end)


def stopped(site: Site, worker: Started, service: Service) -> None:
    kill(service.running.pid, number=signal.SIGSTOP)
    time.sleep(AWAY)
    kill(service.running.pid, number=signal.SIGCONT)


def both(site: Site, worker: Started, service: Service) -> None:
    kill(*service.running.family(), *worker.family())
    until(lambda: service.running.process.poll() is not None, "it ends", 20)
    service.start()


FAULTS = {
    "service killed": Fault(again(signal.SIGKILL), MIDDLE, "slots"),
    "service terminated": Fault(again(signal.SIGTERM), MIDDLE, "slots"),
    "service stopped": Fault(served(stopped), MIDDLE, "slots"),
    "service and worker killed at once": Fault(served(both), MIDDLE, "slots"),
}
