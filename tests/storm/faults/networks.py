"""Workers on machines of their own: cut off from the database in several ways, and a failover in mid-run."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable

from tests.faults import postgres
from tests.faults.machines import Machine, Network
from tests.faults.processes import Started, alive, started, until
from tests.storm.faults.base import PATIENCE, Row, row
from tests.storm.faults.slots import programs
from tests.storm.site import Site

Change = Callable[[Machine], None]
Part = Callable[[Network, str, Site], Row]
PORT = "8000"
ASK = """
import sys, urllib.error, urllib.request
try:
    print(urllib.request.urlopen(sys.argv[1], timeout=60).status)
except urllib.error.HTTPError as error:
    print(error.code)
except OSError:
    print(0)
"""
LONG = 40.0
"""Longer than it takes until both sides give up a silent connection [s]."""


def machine_cut_off(cut: Change, healed: Change, during: Callable[[Site, int], None]) -> Part:
    """Of two machines that which has the run is cut off, another goes on with it; then the first is back and gets the
    next run, without an operator."""

    def part(network: Network, name: str, site: Site) -> Row:
        site.kind = "slots"
        one, two = network.machine("one"), network.machine("two")
        run_id, first = site.begin(), site.start(one)
        until(lambda: site.run(run_id).evaluations > 100, f"{name}: under way", 120)
        simulators = programs(first)
        assert simulators
        cut(one)
        stored, began = site.run(run_id).evaluations, time.monotonic()
        second = site.start(two)
        until(
            lambda: site.run(run_id).evaluations > stored and site.run(run_id).worker == "w2", f"{name}: goes on", 120
        )
        recovery = time.monotonic() - began
        during(site, run_id)
        healed(one)
        until(lambda: site.run(run_id).state in ("done", "failed"), f"{name}: ends", PATIENCE)
        ended = site.run(run_id)
        until(lambda: not any(map(alive, simulators)), f"{name}: the first gives it up", PATIENCE)
        second.process.terminate()
        second.process.wait(30)
        another = site.begin(2)
        until(lambda: site.run(another).state in ("done", "failed"), f"{name}: it takes work again", PATIENCE)
        assert site.run(another).worker == "w1"
        assert site.run(run_id) == ended
        return row(site, "postgresql", name, ended.error or "taken over by the other machine", recovery)

    return part


def at_once(site: Site, run_id: int) -> None:
    """Back as soon as the other machine has the run."""


def much_later(site: Site, run_id: int) -> None:
    """Back after connections were given up."""
    time.sleep(LONG)


def all_cut_off(network: Network, name: str, site: Site) -> Row:
    """The machine of the database is cut off from both workers for longer than any connection lasts."""
    site.kind = "slots"
    one, two = network.machine("one"), network.machine("two")
    runs = [site.begin(1), site.begin(2)]
    site.start(one)
    site.start(two)
    until(lambda: all(site.run(number).evaluations > 100 for number in runs), f"{name}: under way", 120)
    network.machine("db").silenced()
    time.sleep(LONG)
    network.machine("db").plugged()
    stored, began = [site.run(number).evaluations for number in runs], time.monotonic()
    until(
        lambda: all(site.run(n).evaluations > before for n, before in zip(runs, stored, strict=True)),
        f"{name}: goes on",
        PATIENCE,
    )
    recovery = time.monotonic() - began
    until(lambda: all(site.run(number).state in ("done", "failed") for number in runs), f"{name}: ends", PATIENCE)
    return row(site, "postgresql", name, site.run(runs[0]).error or "both went on", recovery)


def service_cut_off(network: Network, name: str, site: Site) -> Row:
    """The machine of the service is cut off from the database, while a worker on another goes on."""
    site.kind = "slots"
    own, run_id = network.machine("service"), site.begin()
    folder = site.folder / own.space
    folder.mkdir()
    environment = {"CLEARANCE_DATA": str(folder), "CLEARANCE_DATABASE": own.url, "CLEARANCE_PORT": PORT}
    command = [*own.within, sys.executable, "-m", "backend"]
    with started(command, site.folder, "service", **site.environment, **environment):
        until(lambda: health(own) == 200, f"{name}: the service is there", 60)
        site.start(network.machine("one"))
        until(lambda: site.run(run_id).evaluations > 100, f"{name}: under way", 120)
        own.silenced()
        began = time.monotonic()
        until(lambda: health(own) == 503, f"{name}: the service says so", PATIENCE)
        noticed = time.monotonic() - began
        own.plugged()
        began = time.monotonic()
        until(lambda: health(own) == 200, f"{name}: it works again", PATIENCE)
        recovery = time.monotonic() - began
    until(site.ended, f"{name}: ends", PATIENCE)
    assert site.run(run_id).losses == 0
    return row(site, "postgresql", name, f"the service answered 503 after {noticed:.0f} s", recovery)


def health(machine: Machine) -> int:
    """The status of the service on this machine, asked there; 0 if nothing answers."""
    ask = [*machine.within, sys.executable, "-c", ASK, f"http://127.0.0.1:{PORT}/api/v1/health"]
    return int(subprocess.run(ask, stdout=subprocess.PIPE, check=True).stdout)


def failover(server: postgres.Server) -> Part:
    """The server ends as by a crash while two machines have a run each, and is restarted."""

    def part(network: Network, name: str, site: Site) -> Row:
        site.kind = "slots"
        runs = [site.begin(1), site.begin(2)]
        workers: list[Started] = [site.start(network.machine(which)) for which in ("one", "two")]
        until(lambda: all(site.run(number).evaluations > 100 for number in runs), f"{name}: under way", 120)
        site.engine.dispose()
        server.stop()
        time.sleep(LONG / 8)
        server.start()
        stored, began = site.run(runs[0]).evaluations, time.monotonic()
        until(lambda: site.run(runs[0]).evaluations > stored, f"{name}: goes on", PATIENCE)
        recovery = time.monotonic() - began
        until(lambda: all(site.run(number).state in ("done", "failed") for number in runs), f"{name}: ends", PATIENCE)
        assert all(one.process.poll() is None for one in workers)
        return row(site, "postgresql", name, site.run(runs[0]).error or "went on", recovery)

    return part


def parts(server: postgres.Server) -> dict[str, Part]:
    """By name."""
    return {
        "two machines: one silenced": machine_cut_off(Machine.silenced, Machine.plugged, at_once),
        "two machines: one silenced for long": machine_cut_off(Machine.silenced, Machine.plugged, much_later),
        "two machines: cable of one pulled": machine_cut_off(Machine.unplugged, Machine.plugged, at_once),
        "two machines: one hears nothing": machine_cut_off(Machine.deafened, Machine.heard, at_once),
        "two machines: database silenced": all_cut_off,
        "machine of the service silenced": service_cut_off,
        "two machines: server stopped at once": failover(server),
    }
