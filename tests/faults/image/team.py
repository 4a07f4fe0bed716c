"""The services of the compose file as a team uses them: with simulators, components and a database of its own."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, field
from pathlib import Path

import httpx

from tests.faults import postgres
from tests.faults.image.compose import Service, services
from tests.faults.image.containers import Container, Network, made, network, running
from tests.faults.image.dockerfile import Stage
from tests.faults.processes import CLEARANCE, REPOSITORY, started, until

ADDRESS = "http://127.0.0.1:8000"
PASSWORD = "a@password:with/signs%and spaces"
EXAMPLES = REPOSITORY / "docs" / "examples"


@dataclass
class Team:
    """A folder with what is mounted, the services, and what runs of them."""

    folder: Path
    image: Stage
    network: Network
    services: dict[str, Service]
    token: str = ""
    headers: dict[str, str] = field(default_factory=lambda: {"accept": "text/html"})

    def running(self, name: str, named: str = "") -> AbstractContextManager[Container]:
        return running(self.services[name], self.image, self.network, self.folder, self.folder, named)

    def get(self, path: str) -> httpx.Response:
        """What the service answers to a holder of the token."""
        given = self.headers | ({"authorization": f"Bearer {self.token}"} if self.token else {})
        with self.network.entered():
            return httpx.get(ADDRESS + path, headers=given, trust_env=False, timeout=100)


@contextmanager
def team(image: Stage, folder: Path, kind: str) -> Iterator[Team]:
    """The folders beside the compose file, and the database; nothing of it is started yet."""
    _simulators(folder / "simulators")
    _components(folder / "components")
    variables = _settings(folder, kind)
    with network(folder) as net:
        found = services(REPOSITORY / "docker-compose.yml", variables)
        made(found, image, folder)
        one = Team(folder, image, net, found)
        with _postgres(folder, net) if kind == "postgresql" else nullcontext():
            yield one


def _settings(folder: Path, kind: str) -> dict[str, str]:
    if kind == "sqlite":
        return {}
    secrets = folder / "secrets"
    secrets.mkdir()
    (secrets / "database_password").write_text(PASSWORD + "\n", encoding="utf-8")
    for path, mode in ((secrets / "database_password", 0o440), (secrets, 0o550)):
        os.chown(path, 10001, 10001)
        path.chmod(mode)
    lines = (REPOSITORY / "deploy" / "postgres.env").read_text(encoding="utf-8").splitlines()
    return dict(line.split("=", 1) for line in lines if line and not line.startswith("#"))


def _simulators(folder: Path) -> None:
    """Two of the guides: a program in Python, and an FMU, which is built here."""
    for name in ("mass_spring", "fmu_drop"):
        shutil.copytree(EXAMPLES / name, folder / name)
    subprocess.run(["sh", str(folder / "fmu_drop" / "build.sh")], check=True, capture_output=True)


def _components(folder: Path) -> None:
    """A vehicle of one's own, as the guide makes it."""
    folder.mkdir()
    environment = os.environ | {"CLEARANCE_COMPONENTS": str(folder), "PYTHONPATH": str(REPOSITORY)}
    command = [*CLEARANCE, "component", "new", "vehicle", "my_robot"]
    subprocess.run(command, env=environment, cwd=REPOSITORY, check=True, capture_output=True)


@contextmanager
def _postgres(folder: Path, net: Network) -> Iterator[None]:
    """This machine's PostgreSQL on the port of the network, with the password of the file."""
    with postgres.binaries() as (programs, home, as_user):
        password = home / "password"
        password.write_text(PASSWORD + "\n", encoding="utf-8")
        password.chmod(0o644)
        data = [*as_user, str(programs / "initdb"), "-D", str(home / "data"), "-U", "clearance", "-N"]
        subprocess.run([*data, "-A", "scram-sha-256", f"--pwfile={password}"], check=True, cwd="/", capture_output=True)
        server = [
            str(programs / "postgres"),
            "-D",
            str(home / "data"),
            "-k",
            str(home),
            "-c",
            "listen_addresses=127.0.0.1",
        ]
        with started(["nsenter", f"--net={net.path}", *as_user, *server], folder, "postgres") as running:
            ask = [
                "psql",
                f"--host={home}",
                "--username=clearance",
                "--dbname=postgres",
                "-c",
                "create database clearance",
            ]
            known = os.environ | {"PGPASSWORD": PASSWORD}
            until(lambda: subprocess.run(ask, env=known, capture_output=True).returncode == 0, "a database")
            assert running.process.poll() is None, running.text()
            yield
