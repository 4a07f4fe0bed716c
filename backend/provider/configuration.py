"""The settings of the sign-in provider, checked at start."""

from __future__ import annotations

import ipaddress
import json
import urllib.parse
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from backend.db.roles import ROLES, Role

PENDING_LIFETIME = 600.0
"""How long a user may take at the provider [s]."""


@dataclass(frozen=True)
class Configured:
    """A provider; `issuer` is exactly the `iss` of its tokens."""

    issuer: str
    client_id: str
    name: str
    """What the button says: Sign in with NAME."""
    redirect: str
    """The address to which the provider returns; it is derived from the public address, never from a request."""
    secret: str = field(repr=False)
    """Empty: a public client, protected by PKCE only."""
    scopes: str
    groups_claim: str
    roles: Mapping[str, Role]
    default_role: Role | None

    def role_of(self, groups: Sequence[str]) -> Role | None:
        """The highest role of the groups, else the default; None: no access."""
        found = [self.roles[group] for group in groups if group in self.roles]
        return max(found, key=ROLES.index) if found else self.default_role


def roles_of(text: str) -> dict[str, Role]:
    """The roles by group, from a JSON object. Raises `ValueError`."""
    try:
        document = json.loads(text or "{}")
    except ValueError:
        document = None
    if not isinstance(document, dict) or not all(role in ROLES for role in document.values()):
        allowed = ", ".join(ROLES)
        raise ValueError(
            f"CLEARANCE_OIDC_ROLES must be a JSON object of groups and roles ({allowed}), such as "
            f'{{"safety-engineers": "engineer"}}, given {text[:200]!r}'
        )
    return document


def default_of(text: str) -> Role | None:
    """The role of a user whose groups have none; None: such a user is refused. Raises `ValueError`."""
    if text and text not in ROLES:
        raise ValueError(f"CLEARANCE_OIDC_DEFAULT_ROLE must be empty or one of {', '.join(ROLES)}, given {text[:60]!r}")
    return next((role for role in ROLES if role == text), None)


def safe_address(address: str) -> bool:
    """Whether an address of a provider is encrypted, or on this machine."""
    try:
        parsed = urllib.parse.urlsplit(address)
        host = parsed.hostname or ""
    except ValueError:
        return False
    if parsed.username or parsed.fragment or not host:
        return False
    return parsed.scheme == "https" or (parsed.scheme == "http" and is_loopback(host))


def is_loopback(host: str) -> bool:
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


@dataclass(frozen=True)
class Identity:
    issuer: str
    subject: str
    name: str
    """What the provider calls the user; a wish only, never an identification."""
    groups: tuple[str, ...]
