"""Addresses of clients, as far as limits tell them apart."""

from __future__ import annotations

import ipaddress
from functools import lru_cache


@lru_cache(4096)
def network(address: str) -> str:
    """The client's address; that of IPv6 is one of a network of 2**64 of the same client."""
    try:
        parsed = ipaddress.ip_address(address.partition("%")[0])
    except ValueError:
        return address[:64]
    if parsed.version == 6 and parsed.ipv4_mapped is not None:
        return str(parsed.ipv4_mapped)
    return str(ipaddress.ip_network(f"{parsed}/64", strict=False)) if parsed.version == 6 else str(parsed)
