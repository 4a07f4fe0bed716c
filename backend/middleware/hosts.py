"""The names by which browsers may call the service: an allow-list of the header Host.

Against DNS rebinding, by which a page of another server reaches a service on this machine under that server's name.
Sources: RFC 9110, 7.2 and 15.5.20 (421).
"""

from __future__ import annotations

import ipaddress
import re
import urllib.parse

from starlette.datastructures import Headers
from starlette.types import Scope

from backend.http.errors import RefusedError

HEALTH = frozenset(f"{place}/health{rest}" for place in ("/api/v1", "") for rest in ("", "/live", "/ready"))
"""Open to every name: health checks call a machine by its address, where such checks look first and in the API."""

_HOST = re.compile(r"([A-Za-z0-9._~-]{1,253}|\[[0-9A-Fa-f:.]{2,45}\])(:[0-9]{1,5})?")


class Hosts:
    """Allows this machine, the host that the service is bound to, its public address and the names of the settings."""

    def __init__(self, bound: str, public_url: str, more: str, any_host: bool) -> None:
        """more: names separated by spaces. any_host: whether every name is allowed if none of them is given."""
        public = urllib.parse.urlsplit(public_url).hostname or ""
        self.names = frozenset(name.lower() for name in (public, *more.split()) if name)
        self.every = "*" in self.names or (any_host and not self.names)
        self._bound = bound.lower()

    def allows(self, host: str) -> bool:
        """Whether the whole header is a name, with or without a port, and the name is one of these; of names that were
        given with a port, with that port."""
        if not _HOST.fullmatch(host):
            return self.every and not host  # HTTP/1.0
        name = _name(host)
        return self.every or bool({name, host.lower()} & self.names) or name == self._bound or _is_this_machine(name)

    def refusal(self, scope: Scope) -> RefusedError | None:
        """421 for a request or socket under another name."""
        host = Headers(scope=scope).get("host", "")
        if scope["path"] in HEALTH or self.allows(host):
            return None
        detail = (
            f"this service does not answer to the name {host[:200]!r}: use its address, or have its operator add the "
            "name to CLEARANCE_ALLOWED_HOSTS"
        )
        return RefusedError("unknown-host", detail)


def _name(host: str) -> str:
    if host.startswith("["):
        return host[1:].partition("]")[0].lower()
    return host.partition(":")[0].rstrip(".").lower()


def _is_this_machine(name: str) -> bool:
    if name == "localhost":
        return True
    try:
        return ipaddress.ip_address(name).is_loopback
    except ValueError:
        return False
