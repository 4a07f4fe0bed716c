"""Starts the services of the compose file in the files of the image: read-only, without rights, without an engine.

Every container has mounts, processes, a host name and shared memory of its own, and a root from which Linux permits
no name spaces of users, as the engines' filter of system calls forbids them. The containers of a test share one network
without a way out.
"""

from __future__ import annotations

import ctypes
import os
import shlex
import subprocess
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from tests.faults.image.compose import NAMED, Service
from tests.faults.image.dockerfile import Stage
from tests.faults.image.rooted import mounts
from tests.faults.processes import Started, command_of, descendants, started, until

FIRST = "/usr/bin/tini"
"""What engines start first in a container with `init: true`."""
NAMES = "127.0.0.1 localhost backend worker postgres scheduler node\n"
TMPFS = "nosuid,nodev,noexec"
"""What engines add to the options of a `tmpfs`, unless they say the contrary."""


class Container:
    """A running service."""

    def __init__(self, service: Service, image: Stage, process: Started) -> None:
        self.service, self.image, self.process = service, image, process

    def text(self) -> str:
        return self.process.text()

    @property
    def first(self) -> int:
        """The process that has the number 1 inside; 0 until everything is mounted."""
        found = [pid for pid in descendants(self.process.pid) if command_of(pid).startswith(FIRST)]
        return found[0] if found else 0

    def run(self, *command: str) -> subprocess.CompletedProcess[str]:
        """A command inside, as `docker compose exec` and health checks run it."""
        spaces = ["--mount", "--pid", "--uts", "--ipc", "--net"]
        inside = _as_user(self.image, _variables(self.service, self.image), list(command))
        whole = ["nsenter", f"--target={self.first}", *spaces, "chroot", str(self.image.root), *inside]
        return subprocess.run(whole, capture_output=True, text=True, check=False, timeout=1200)

    def healthy(self) -> bool:
        """Whether the health check of the compose file succeeds."""
        return self.run(*self.service.check).returncode == 0


class Network:
    """A network name space with the loopback address only."""

    def __init__(self, holder: int) -> None:
        self.path = f"/proc/{holder}/ns/net"

    @contextmanager
    def entered(self) -> Iterator[None]:
        """This thread is in it meanwhile."""
        own, there = os.open("/proc/thread-self/ns/net", os.O_RDONLY), os.open(self.path, os.O_RDONLY)
        try:
            _enter(there)
            yield
        finally:
            _enter(own)
            os.close(own)
            os.close(there)


@contextmanager
def network(folder: Path) -> Iterator[Network]:
    with started(
        ["unshare", "--net", "sh", "-c", "ip link set lo up && echo up && exec tail -f /dev/null"], folder, "net"
    ) as holder:
        until(lambda: "up" in holder.text(), "a network")
        yield Network(holder.pid)


@contextmanager
def running(
    service: Service, image: Stage, network: Network, folder: Path, volumes: Path, named: str = ""
) -> Iterator[Container]:
    """The service; volumes: the folder of its volumes, also of those that are folders beside the compose file."""
    name = named or service.name
    hosts = folder / f"{name}.hosts"
    hosts.write_text(NAMES.strip() + f" {name}\n", encoding="utf-8")
    named_hosts = f"touch {image.root}/etc/hosts && mount --bind {shlex.quote(str(hosts))} {image.root}/etc/hosts"
    lines = ["set -e", f"mount --bind {image.root} {image.root}", f"hostname {name}", *mounts(image.root), named_hosts]
    lines += _mounted(service, image.root, volumes)
    given = _as_user(image, _variables(service, image), service.command or image.command)
    lines.append(shlex.join(["exec", "chroot", str(image.root), FIRST, "--", *given]))
    spaces = ["--mount", "--pid", "--uts", "--ipc", "--fork", "--kill-child"]
    command = ["nsenter", f"--net={network.path}", "unshare", *spaces, "bash", "-c", "\n".join(lines)]
    with started(command, folder, name) as process:
        container = Container(service, image, process)
        until(lambda: container.first or process.process.poll() is not None, "started")
        assert container.first, process.text()
        yield container


def _mounted(service: Service, root: Path, volumes: Path) -> list[str]:
    """Lines for temporary folders and volumes; then nothing else of the image can be written."""
    lines: list[str] = []
    for target, options in service.tmpfs:
        own = options.split(",") if options else []
        kept = [each for each in TMPFS.split(",") if each.removeprefix("no") not in own]
        lines.append(f"mount -t tmpfs -o {','.join([*kept, *(o for o in own if o != 'exec')])} tmpfs {root}{target}")
    for source, target, read_only in service.volumes:
        at, there = volumes / source, f"{root}{target}"
        lines += [f"mkdir -p {there}", f"mount --bind {shlex.quote(str(at))} {there}"]
        if read_only:
            lines.append(f"mount -o remount,bind,ro {there}")
    return [*lines, f"mount -o remount,bind,ro {root}"]


def made(services: Mapping[str, Service], image: Stage, volumes: Path) -> None:
    """Make the folders of volumes, as engines do: a named one has the owner and mode of the folder in the image."""
    for service in services.values():
        for source, target, _ in service.volumes:
            (volumes / source).mkdir(parents=True, exist_ok=True)
            if source in NAMED and (image.root / target.lstrip("/")).is_dir():
                status = (image.root / target.lstrip("/")).stat()
                os.chown(volumes / source, status.st_uid, status.st_gid)
                (volumes / source).chmod(status.st_mode & 0o7777)


def _variables(service: Service, image: Stage) -> dict[str, str]:
    entries = (line.split(":") for line in (image.root / "etc/passwd").read_text(encoding="utf-8").splitlines())
    home = next(entry[5] for entry in entries if entry[2] == image.user.partition(":")[0])
    return {"HOME": home} | image.environment | service.environment


def _as_user(image: Stage, variables: Mapping[str, str], command: list[str]) -> list[str]:
    user, _, group = image.user.partition(":")
    rights = ["--no-new-privs", "--bounding-set=-all", "--inh-caps=-all"]
    as_user = ["setpriv", f"--reuid={user}", f"--regid={group}", "--clear-groups", *rights]
    given = [f"{name}={value}" for name, value in variables.items()]
    return [*as_user, "env", "-i", "-C", image.folder, *given, *command]


def _enter(descriptor: int) -> None:
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.setns(descriptor, 0x40000000) != 0:
        raise OSError(ctypes.get_errno(), "the network name space cannot be entered")
