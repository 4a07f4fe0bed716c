"""`python -m tests.bench.doors [seconds]`: who is answered how soon while others flood the service with connections.

Throws 1,000 connections of each kind at a service, by visitors without login and by one viewer with 20 tokens, from the
address of whoever asks and from others, and asks for /health and for the runs of another user meanwhile, each time on a
new connection. Prints the slowest and the median answer, and every answer that was not 200.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from statistics import median
from typing import NamedTuple

from backend.db import users
from backend.db.access import MOST_TOKENS, create_token
from backend.db.engine import default_url
from backend.settings import Settings
from tests import migrated
from tests.given.floods import STRANGERS, VIEWERS, Asked, Flood, ask, flooded
from tests.given.service import Service
from tests.given.submissions import submit

MANY = tuple(f"127.0.{i // 200}.{i % 200 + 2}" for i in range(400))
SOURCES = ("127.0.0.1", "127.9.9.9")
PATHS = ("/api/v1/health", "/api/v1/runs")


class Besieged(NamedTuple):
    """A service with a run, a viewer's tokens, and the token of another user."""

    port: int
    viewer: tuple[str, ...]
    other: str


@contextmanager
def besieged(folder: Path) -> Iterator[Besieged]:
    migrated.migrated(folder / "data")
    service = Service(Settings(data=folder / "data", database=default_url(folder / "data"), pages=folder / "dist"))
    service.start()
    try:
        service.publish()
        with service.signed_in() as client:
            submit(client)
        with service.engine.begin() as writer:
            for name in ("vera", "ada"):
                users.accept(writer, users.invite(writer, name, "viewer", "local"), "hash")
            tokens = tuple(create_token(writer, f"vera-{i}", "vera", "read") for i in range(MOST_TOKENS))
            other = create_token(writer, "ada-ci", "ada", "read")
        yield Besieged(service.port, tokens, other)
    finally:
        service.stop()


def floods(port: int, tokens: tuple[str, ...]) -> list[Flood]:
    """Every kind from the address of whoever asks; of visitors without login also from 400 others."""
    unknown = [Flood(port, kind, sent) for kind, sent in STRANGERS.items()]
    unread = Flood(
        port,
        "openings of the login page that are not read",
        "GET /login HTTP/1.1\r\nHost: localhost\r\n\r\n" * 500,
        reads=False,
    )
    known = [Flood(port, kind, sent, tokens) for kind, sent in VIEWERS.items()]
    slow = replace(known[1], kind="3D views that are not read", reads=False)
    return [*unknown, unread, *(replace(one, sources=MANY) for one in unknown[:4]), *known, slow]


def main() -> None:
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 10.0
    print(f"load of the machine {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors, {seconds:g} s each")
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "tests.bench.doors", "--serve", folder]
        with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            port, other, *tokens = process.stdout.readline().split()
            for flood in floods(int(port), tuple(tokens)):
                with flooded(flood):
                    print(line(flood, asked(int(port), other, seconds)), flush=True)
            process.stdin.close()  # type: ignore[union-attr]


def asked(port: int, other: str, seconds: float) -> list[Asked]:
    """Both questions, from the address of the flood and from another, at the same time."""

    def answers(question: tuple[str, str]) -> Asked:
        path, source = question
        return ask(port, path, seconds, other if "runs" in path else "", source)

    with ThreadPoolExecutor(4) as threads:
        return list(threads.map(answers, ((path, source) for source in SOURCES for path in PATHS)))


def line(flood: Flood, answers: list[Asked]) -> str:
    where = "" if len(flood.sources) == 1 else f", {len(flood.sources)} addresses"
    names = ("health", "runs", "health of another address", "runs of another address")
    shown = []
    for name, one in zip(names, answers, strict=True):
        failed = f", NOT ANSWERED {len(one.failed)}: {', '.join(sorted(set(one.failed)))}" if one.failed else ""
        shown.append(
            f"{name} {max(one.seconds):.2f} (median {median(one.seconds):.3f}, {len(one.seconds)} asked{failed})"
        )
    return f"{flood.kind}{where}\n    " + "\n    ".join(shown)


def serve(folder: Path) -> None:
    """The service in a process of its own, until standard input ends."""
    with besieged(folder) as service:
        print(service.port, service.other, *service.viewer, flush=True)
        sys.stdin.read()


if __name__ == "__main__":
    if sys.argv[1:2] == ["--serve"]:
        serve(Path(sys.argv[2]))
    else:
        main()
