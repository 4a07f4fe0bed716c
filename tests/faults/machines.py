"""Machines on a network of their own: network namespaces on a switch, which can be cut off from it in several ways.

They need root and `ip`; without, the tests that need them are skipped. Nothing of it is seen outside the namespaces.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

NETWORK = "198.18.77.0/24"
"""Of those set apart for tests of networks (RFC 2544)."""


class Machine:
    """A machine with one cable to the switch."""

    def __init__(self, network: Network, name: str, number: int) -> None:
        self.space, self.port = f"{network.name}{name}", f"port{number}"
        self.address = _address(number)
        self.within = ["ip", "netns", "exec", self.space]
        self._switch = network.name
        self.url = f"postgresql://clearance@{network.database}/postgres"
        """Of the database server on the network."""

    def unplugged(self) -> None:
        """Its cable is pulled: it has no carrier; open connections are not told."""
        _ip("-n", self._switch, "link", "set", self.port, "down")

    def silenced(self) -> None:
        """The switch drops all that it sends and gets, and tells nobody."""
        _ip("-n", self._switch, "link", "set", self.port, "nomaster")

    def deafened(self) -> None:
        """What it sends arrives, what is sent to it is lost."""
        _run("ip", "netns", "exec", self._switch, "tc", "qdisc", "add", "dev", self.port, "root", "pfifo", "limit", "0")

    def heard(self) -> None:
        """The end of `deafened`."""
        _run("ip", "netns", "exec", self._switch, "tc", "qdisc", "del", "dev", self.port, "root")

    def plugged(self) -> None:
        """As before `unplugged` and `silenced`."""
        _ip("-n", self._switch, "link", "set", self.port, "master", "switch", "up")

    def moved(self, address: str) -> None:
        """It takes over the address of another machine, and says so."""
        _ip("-n", self.space, "address", "add", f"{address}/24", "dev", "eth0")


class Network:
    """A switch and its machines; the first one has the database server."""

    def __init__(self, name: str) -> None:
        self.name, self.database = name, _address(1)
        self.machines: dict[str, Machine] = {}

    def machine(self, name: str) -> Machine:
        """The machine of that name, connected at its first use."""
        if name in self.machines:
            return self.machines[name]
        made = self.machines[name] = Machine(self, name, len(self.machines) + 1)
        _ip("netns", "add", made.space)
        cable = ("type", "veth", "peer", "name", "eth0", "netns", made.space)
        _ip("-n", self.name, "link", "add", "name", made.port, *cable)
        _ip("-n", made.space, "address", "add", f"{made.address}/24", "dev", "eth0")
        for device in ("lo", "eth0"):
            _ip("-n", made.space, "link", "set", device, "up")
        made.plugged()
        return made


@contextmanager
def network() -> Iterator[Network]:
    """A switch while the block lasts; skips the test where that is not permitted."""
    if os.geteuid() != 0 or shutil.which("ip") is None:
        pytest.skip("network namespaces need root and `ip` (Debian: apt-get install iproute2)")
    made = Network(f"storm{os.getpid()}")
    if subprocess.run(["ip", "netns", "add", made.name], capture_output=True, check=False).returncode:
        pytest.skip("network namespaces are not permitted here")
    try:
        _ip("-n", made.name, "link", "add", "name", "switch", "type", "bridge")
        _ip("-n", made.name, "link", "set", "switch", "up")
        yield made
    finally:
        for machine in made.machines.values():
            subprocess.run(["ip", "netns", "delete", machine.space], check=False)
        _ip("netns", "delete", made.name)


def _address(number: int) -> str:
    return NETWORK.replace("0/24", str(number))


def _ip(*words: str) -> None:
    _run("ip", *words)


def _run(*command: str) -> None:
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    assert done.returncode == 0, f"{command}: {done.stdout}"
