"""A machine that is cut off from the database loses its run to another, writes nothing more into it, and comes back."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import sqlalchemy as sa

from backend.db.engine import connect, migrate
from backend.db.queue import request_cancel, submit
from tests.faults import machines, postgres
from tests.faults.cases import campaign
from tests.faults.machines import Machine, Network
from tests.faults.processes import REPOSITORY, Started, alive, until, worker
from tests.faults.stored import Stored

pytestmark = pytest.mark.nightly  # by day tests/faults/test_outages.py

OPTIONS = ("--runner", "tests.faults.jobs:execute", "--lease", "2")
SOONER = "?tcp_user_timeout=3000"
"""Silence counts as away after this time [ms]."""

HOLDER = """
import sys
import sqlalchemy as sa
from backend.db import engine
engine.CLIENT_LIMITS.update(tcp_keepalives_idle=1, tcp_keepalives_interval=1, tcp_user_timeout=3000)
with engine.connect(sys.argv[1]).begin() as connection:
    connection.execute(sa.text("select id from runs for update"))
    print("held", flush=True)
    sys.stdin.read()
"""


class Bench(Stored):
    """The database, reached by its socket."""

    def __init__(self, url: str) -> None:
        self.engine = connect(url)

    def submit(self, name: str, **more: str) -> int:
        """A run of this accident."""
        asked = campaign(name=name, **more)
        with self.engine.begin() as connection:
            return submit(connection, asked, name=name, tags=[], owner="", planned=0)


@pytest.fixture(scope="module")
def switch() -> Iterator[Network]:
    with machines.network() as made:
        yield made


@pytest.fixture(scope="module")
def server(switch: Network) -> Iterator[postgres.Server]:
    at = switch.machine("db")
    with postgres.server(at.within, at.address, machines.NETWORK) as running:
        migrate(running.url)
        yield running


@pytest.fixture
def bench(server: postgres.Server) -> Iterator[Bench]:
    made = Bench(server.url)
    yield made
    made.engine.dispose()


@contextmanager
def working(switch: Network, name: str, folder: Path) -> Iterator[Started]:
    """A worker on the machine of its name, with a data folder of its own."""
    data = folder / name
    data.mkdir()
    at = switch.machine(name)
    with worker(at.url + SOONER, data, name, *OPTIONS, "--data", str(data), within=at.within) as running:
        yield running


@pytest.mark.parametrize(
    ("cut", "healed"),
    [
        pytest.param(Machine.silenced, Machine.plugged, marks=pytest.mark.nightly),
        pytest.param(Machine.unplugged, Machine.plugged, marks=pytest.mark.nightly),
        pytest.param(Machine.deafened, Machine.heard, marks=pytest.mark.nightly),
    ],
)
def test_a_machine_that_is_cut_off(
    switch: Network,
    bench: Bench,
    tmp_path: Path,
    cut: Callable[[Machine], None],
    healed: Callable[[Machine], None],
) -> None:
    """Its run stands still, so that what the other machine has of it is known."""
    with working(switch, "one", tmp_path) as first:
        run_id = bench.submit("hang", summary=str(tmp_path / "happened"))
        until(lambda: bench.run(run_id).evaluations == 201, "half of it")
        child = first.child()
        cut(switch.machine("one"))
        with working(switch, "two", tmp_path):
            ended = bench.ended(run_id)
            assert (ended.state, ended.worker, ended.losses) == ("done", "two", 0)
        assert alive(child)
        healed(switch.machine("one"))
        until(lambda: not alive(child), "its process is ended")
        another = bench.ended(bench.submit("none"))
        assert (another.state, another.worker) == ("done", "one"), first.text()
        assert bench.run(run_id) == ended


def test_a_machine_that_is_cut_off_within_a_transaction(switch: Network, bench: Bench) -> None:
    """The server ends its session, or nobody could take the run. The times are shortened."""
    at, run_id = switch.machine("one"), bench.submit("none")
    command = [*at.within, sys.executable, "-c", HOLDER, at.url]
    with subprocess.Popen(command, cwd=REPOSITORY, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as holder:
        assert holder.stdout is not None
        assert holder.stdout.readline() == b"held\n"
        at.silenced()
        try:
            free = sa.text("select id from runs where id = :run for update")
            with bench.engine.begin() as connection:
                connection.execute(sa.text("set local lock_timeout = '20s'"))
                assert connection.scalar(free, {"run": run_id}) == run_id
        finally:
            at.plugged()
            holder.kill()
    with bench.engine.begin() as connection:
        request_cancel(connection, run_id)
