"""The webhooks of the settings: their addresses and the secret that signs messages."""

from __future__ import annotations

import base64
import binascii
import hashlib
import urllib.parse
from dataclasses import dataclass, field

PREFIX = "whsec_"
LEAST = 24
"""Bytes of the secret, as Standard Webhooks recommends."""
MOST = 10
"""Addresses."""
HOW = f"make one with: echo {PREFIX}$(openssl rand -base64 32)"


@dataclass(frozen=True)
class Target:
    """One address. Its path and user may be secrets: neither is shown, logged or stored."""

    url: str = field(repr=False)
    private: bool
    """Whether it may be in a private network, and use HTTP without encryption."""

    @property
    def id(self) -> str:
        """Identifies the address without disclosing it."""
        return hashlib.sha256(self.url.encode()).hexdigest()[:16]

    @property
    def origin(self) -> str:
        return _origin(urllib.parse.urlsplit(self.url))


@dataclass(frozen=True)
class Configured:
    targets: tuple[Target, ...] = ()
    key: bytes = field(default=b"", repr=False)


def configured(addresses: str, secret: str, private: bool) -> Configured:
    """The webhooks of the settings; raises `ValueError` with a sentence that contains neither path nor secret."""
    urls = addresses.split()
    if not urls:
        return Configured()
    if len(urls) > MOST:
        raise ValueError(f"CLEARANCE_WEBHOOKS: {len(urls)} addresses, at most {MOST} are allowed")
    targets = tuple(_target(address, i, private) for i, address in enumerate(dict.fromkeys(urls), 1))
    return Configured(targets, _key(secret))


def _target(address: str, number: int, private: bool) -> Target:
    name = f"CLEARANCE_WEBHOOKS: address {number}"
    try:
        parts = urllib.parse.urlsplit(address)
        _ = parts.port
    except ValueError:
        raise ValueError(f"{name} is not an address; give one such as https://host/path") from None
    if parts.scheme not in ("http", "https") or not parts.hostname or not address.isascii():
        raise ValueError(f"{name} is not an address of the web; give one such as https://host/path")
    if parts.scheme == "http" and not private:
        raise ValueError(
            f"{name} ({_origin(parts)}) is not encrypted; give an https address, or set "
            f"CLEARANCE_WEBHOOK_PRIVATE=true if it is in your own network"
        )
    return Target(address, private)


def _key(secret: str) -> bytes:
    if not secret:
        raise ValueError(f"CLEARANCE_WEBHOOK_SECRET: a secret that signs the messages is required; {HOW}")
    try:
        key = base64.b64decode(secret.removeprefix(PREFIX), validate=True)
    except (binascii.Error, ValueError):
        key = b""
    if not secret.startswith(PREFIX) or len(key) < LEAST:
        raise ValueError(
            f"CLEARANCE_WEBHOOK_SECRET: not a secret, which is {PREFIX} and at least {LEAST} bytes in base64; {HOW}"
        )
    return key


def _origin(parts: urllib.parse.SplitResult) -> str:
    host = f"[{parts.hostname}]" if ":" in (parts.hostname or "") else parts.hostname
    return f"{parts.scheme}://{host}{f':{parts.port}' if parts.port else ''}"
