"""Commands of a build inside the files of an image, as root, in name spaces of their own."""

from __future__ import annotations

import shlex
import subprocess
from collections.abc import Mapping
from pathlib import Path

from tests.faults.image.base import reach

PATH = "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"
"""That of the official images."""


def rooted(root: Path, command: str, folder: str = "/", environment: Mapping[str, str] | None = None) -> str:
    """Run a line of shell there and return what it printed; a failure is an error with the end of it."""
    variables = {"PATH": PATH, "HOME": "/root"} | reach() | dict(environment or {})
    given = [f"{name}={value}" for name, value in variables.items()]
    inside = ["chroot", str(root), "env", "-i", "-C", folder, *given, "/bin/sh", "-c", command]
    lines = ["set -e", *mounts(root), shlex.join(["exec", *inside])]
    done = subprocess.run(
        ["unshare", "--mount", "--pid", "--fork", "--kill-child", "bash", "-c", "\n".join(lines)],
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
    )  # fmt: skip
    if done.returncode != 0:
        raise RuntimeError(f"{command} ended with {done.returncode}:\n{done.stdout[-4000:]}")
    return done.stdout


def mounts(root: Path) -> list[str]:
    """Lines that mount what an engine mounts in every container: processes, devices, and how names are resolved."""
    at = shlex.quote(str(root))
    devices = [
        f"touch {at}/dev/{n} && mount --bind /dev/{n} {at}/dev/{n}" for n in ("null", "zero", "random", "urandom")
    ]
    return [
        f"mount -t proc proc {at}/proc",
        f"mount -t tmpfs -o mode=755 tmpfs {at}/dev",
        *devices,
        f"ln -s /proc/self/fd {at}/dev/fd",
        f"mkdir {at}/dev/shm && mount -t tmpfs -o mode=1777 tmpfs {at}/dev/shm",
        f"touch {at}/etc/resolv.conf && mount --bind /etc/resolv.conf {at}/etc/resolv.conf",
    ]
