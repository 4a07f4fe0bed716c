"""The provider's own documents: its configuration and its keys, fetched when needed and stored for an hour.

OpenID Connect Discovery 1.0, section 4; RFC 7517.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

import httpx
from joserfc.errors import JoseError
from joserfc.jwk import KeySet

from backend.provider.configuration import Configured, safe_address
from backend.provider.errors import SignInError, unreachable

PATIENCE = 10.0
"""Time limit of each request to the provider [s]."""

KEPT = 3600.0
"""How long the documents are used [s]."""

AGAIN = 10.0
"""Keys are fetched again for an unknown key at most this often [s]: providers replace their keys."""

PAUSE = 2.0
"""After a failure the configuration is not fetched again so long [s]: of many clients one waits for a provider."""

LARGEST = 1_000_000
"""Maximum size of an answer of the provider [bytes]."""


class Documents:
    """Configuration and keys of one provider; used on one event loop."""

    def __init__(self, configured: Configured) -> None:
        self._of = configured
        self._metadata: dict[str, object] = {}
        self._keys: KeySet | None = None
        self._metadata_at = self._keys_at = -KEPT
        self._failure: SignInError | None = None
        self._failed_at = 0.0

    async def metadata(self) -> dict[str, object]:
        """The configuration; its issuer is the configured one, and its addresses are encrypted or on this machine."""
        at = time.monotonic()
        if at - self._metadata_at < KEPT:
            return self._metadata
        if self._failure is not None and at - self._failed_at < PAUSE:
            raise self._failure
        try:
            self._metadata, self._metadata_at = await self._fetched(), time.monotonic()
        except SignInError as error:
            self._failure, self._failed_at = error, time.monotonic()
            raise
        return self._metadata

    async def _fetched(self) -> dict[str, object]:
        address = f"{self._of.issuer.rstrip('/')}/.well-known/openid-configuration"
        found = await fetch(self._of.name, "GET", address)
        if found.get("issuer") != self._of.issuer:
            raise unreachable(self._of.name, "the configuration names another issuer")
        for name in ("authorization_endpoint", "token_endpoint", "jwks_uri"):
            if not safe_address(str(found.get(name, ""))):
                raise unreachable(self._of.name, f"the configuration has no safe {name}")
        return found

    async def keys(self, fresh: bool = False) -> KeySet:
        """The provider's keys. fresh: fetch them again, unless that was done seconds ago."""
        age = time.monotonic() - self._keys_at
        if self._keys is not None and age < (AGAIN if fresh else KEPT):
            return self._keys
        found = await fetch(self._of.name, "GET", str((await self.metadata())["jwks_uri"]))
        try:
            # A key of a kind that is not known here must not hide the others.
            entries = found["keys"]
            if not isinstance(entries, list):
                raise TypeError
            listed = [key for key in entries if key.get("kty") in ("RSA", "EC", "OKP")]
            keys = KeySet.import_key_set({"keys": [key for key in listed if key.get("use", "sig") == "sig"]})
        except (JoseError, ValueError, KeyError, TypeError, AttributeError):
            raise unreachable(self._of.name, "the keys are not a JSON web key set") from None
        self._keys, self._keys_at = keys, time.monotonic()
        return keys


async def fetch(
    name: str, method: str, address: str, headers: Mapping[str, str] | None = None, **options: Any
) -> dict[str, object]:
    """A JSON object from the provider; redirects are not followed. Raises `SignInError`."""
    named = {"Accept": "application/json", **(headers or {})}
    try:
        async with httpx.AsyncClient(timeout=PATIENCE, follow_redirects=False) as client:
            answer = await client.request(method, address, headers=named, **options)
        found = answer.json() if len(answer.content) <= LARGEST else None
    except (httpx.HTTPError, httpx.InvalidURL, ValueError, OSError) as error:
        raise unreachable(name, f"no answer: {type(error).__name__}") from None
    if not isinstance(found, dict):
        raise unreachable(name, "the answer is not a JSON object")
    if answer.status_code != 200:
        raise _refused(name, answer.status_code, found)
    return found


def _refused(name: str, status: int, found: dict[str, object]) -> SignInError:
    code = str(found.get("error", ""))[:60]
    reason = f"status {status}{f', {code}' if code.isprintable() and code else ''}"
    if code in ("invalid_grant", "invalid_client", "unauthorized_client"):
        sentence = f"{name} did not accept this sign-in ({code}). Sign in again; if that fails, ask an administrator."
        return SignInError(sentence, 403, reason)
    return unreachable(name, reason)
