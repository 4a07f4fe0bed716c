"""The path below which browsers find the service, such as /clearance behind a proxy; empty for the root of a host.

It is the path of the public address (`backend.settings`), set for each request by `backend.middleware.proxy`. Code
inside the service uses paths without it; what a browser receives goes through `at`.
"""

from __future__ import annotations

from contextvars import ContextVar

ROOT: ContextVar[str] = ContextVar("root", default="")


def at(path: str) -> str:
    """The path as a browser requests it: `/runs` becomes `/clearance/runs`."""
    return ROOT.get() + path


def cookie_path() -> str:
    """The path of the service's cookies, its own only, so that other services on the host do not get them."""
    return ROOT.get() or "/"


def inside(path: str) -> str | None:
    """A path of a browser as the service has it; None if it is outside the service."""
    root = ROOT.get()
    if not root:
        return path
    return path[len(root) :] or "/" if path == root or path.startswith((f"{root}/", f"{root}?")) else None
