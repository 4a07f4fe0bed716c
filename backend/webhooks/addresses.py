"""The network addresses of a host, without those that a webhook must not reach.

A name is resolved once, and the connection goes to the address that was checked: otherwise a name server could answer
differently the second time (DNS rebinding).
"""

from __future__ import annotations

import ipaddress
import socket
from functools import partial

import anyio
import anyio.to_thread

_UNICAST = ipaddress.ip_network("2000::/3")
"""All IPv6 addresses that are assigned for use everywhere (IANA, "IPv6 Address Space"): IPv4 addresses that are mapped,
translated or compatible, and site-local ones, are outside it."""


class RefusedAddressError(ValueError):
    """The host has no address that may be reached."""


async def resolved(host: str, port: int, private: bool) -> str:
    """The first address of a host. Refuses a host of which any address is private, unless that is allowed."""
    named = partial(socket.getaddrinfo, host, port, type=socket.SOCK_STREAM)
    try:
        # In a thread of its own, which is left behind if the name server does not answer in time.
        found = await anyio.to_thread.run_sync(named, abandon_on_cancel=True, limiter=anyio.CapacityLimiter(1))
    except OSError as error:
        raise RefusedAddressError(f"the name {host} cannot be resolved: {error.strerror or error}") from None
    except UnicodeError:
        raise RefusedAddressError(f"the name {host[:60]} is not valid") from None
    addresses = [str(entry[4][0]) for entry in found]
    refused = next((address for address in addresses if not private and not is_public(address)), None)
    if refused is not None:
        raise RefusedAddressError(
            f"{host} has the address {refused}, which is in a private network; only "
            f"CLEARANCE_WEBHOOK_PRIVATE=true allows that"
        )
    return addresses[0]


def is_public(address: str) -> bool:
    """Whether an address is reachable from everywhere; false for one that embeds an IPv4 address."""
    ip = ipaddress.ip_address(address.partition("%")[0])
    if isinstance(ip, ipaddress.IPv6Address) and (ip not in _UNICAST or ip.sixtofour or ip.teredo):
        return False
    return ip.is_global and not ip.is_multicast
