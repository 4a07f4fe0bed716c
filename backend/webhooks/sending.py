"""Sends one message: signed, to a checked address, within a time limit, without following redirects. Read `send`.

Source: Standard Webhooks 1.0. The signature is HMAC-SHA256 over `id.timestamp.body`; the timestamp lets a receiver
refuse a replayed message.
"""

from __future__ import annotations

import asyncio
import base64
import hashlib
import hmac
import http
import ssl
from dataclasses import dataclass

import httpx

from backend.webhooks.addresses import RefusedAddressError, resolved
from backend.webhooks.configuration import Target
from campaigns.version import VERSION

LIMIT = 10.0
"""For a whole attempt, from the name to the response's status [s]."""
LONGEST = 300
"""Characters of a reason."""


@dataclass(frozen=True)
class Message:
    """What is sent: the same id and body in every attempt."""

    id: str
    body: str
    attempt: int


@dataclass(frozen=True)
class Sent:
    status: int | None
    error: str | None
    """A sentence; None if the receiver accepted the message."""


def signature(key: bytes, message: Message, at: int) -> str:
    """The signature of a message sent at that time [s since 1970]."""
    signed = f"{message.id}.{at}.{message.body}".encode()
    return "v1," + base64.b64encode(hmac.new(key, signed, hashlib.sha256).digest()).decode()


def headers(key: bytes, message: Message, at: int) -> dict[str, str]:
    return {
        "content-type": "application/json",
        "user-agent": f"Clearance/{VERSION}",
        "webhook-id": message.id,
        "webhook-timestamp": str(at),
        "webhook-signature": signature(key, message, at),
        "clearance-attempt": str(message.attempt),
    }


async def send(
    target: Target, key: bytes, message: Message, at: int, tls: ssl.SSLContext, limit: float = LIMIT
) -> Sent:
    """Send a message once; a failure is an outcome with a sentence."""
    try:
        async with asyncio.timeout(limit):
            status = await _status(target, headers(key, message, at), message.body.encode(), tls)
    except TimeoutError:
        return Sent(None, f"{target.origin} did not answer within {limit:g} s")
    except RefusedAddressError as error:
        return Sent(None, str(error)[:LONGEST])
    except (httpx.HTTPError, httpx.InvalidURL, ssl.SSLError, OSError) as error:
        return Sent(None, f"{target.origin} could not be reached: {str(error) or type(error).__name__}"[:LONGEST])
    return Sent(status, _refusal(target, status))


async def _status(target: Target, headers: dict[str, str], body: bytes, tls: ssl.SSLContext) -> int:
    """The status of the response; its body is not read."""
    url = httpx.URL(target.url)
    address = await resolved(url.host, url.port or (443 if url.scheme == "https" else 80), target.private)
    headers = {**headers, "host": url.netloc.decode()}
    named = {"sni_hostname": url.host}  # the certificate must be that of the name, not of the address
    # Without the proxies of the environment, which would resolve the name themselves.
    async with (
        httpx.AsyncClient(verify=tls, trust_env=False, timeout=None) as client,
        client.stream("POST", url.copy_with(host=address), content=body, headers=headers, extensions=named) as response,
    ):
        return response.status_code


def _refusal(target: Target, status: int) -> str | None:
    if 200 <= status < 300:
        return None
    try:
        phrase = f" {http.HTTPStatus(status).phrase}"
    except ValueError:
        phrase = ""
    more = ", a redirect, which is not followed; configure its final address" if 300 <= status < 400 else ""
    return f"{target.origin} responded with {status}{phrase}{more}"
