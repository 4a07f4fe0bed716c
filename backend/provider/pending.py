"""A sign-in that waits for the provider: state, nonce and PKCE verifier, in a signed cookie of the browser.

Nothing of it is stored here, so a client cannot fill the memory. A state is single-use; used ones are remembered until
they would expire. The key is new at every start: a restart ends the sign-ins that wait.
"""

from __future__ import annotations

import hmac
import secrets
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass

from joserfc import jwt
from joserfc.errors import JoseError
from joserfc.jwk import OctKey

from backend.provider.configuration import PENDING_LIFETIME
from backend.provider.errors import stale

MOST = 20_000
"""Used states that are remembered; beyond that the oldest are forgotten, whose codes the provider accepts only once."""


@dataclass(frozen=True)
class Started:
    """One sign-in: 256 random bits each; back: where it leads."""

    state: str
    nonce: str
    verifier: str
    back: str
    expires: float


class Pending:
    """Issues and accepts sign-ins; used on one event loop."""

    def __init__(self, clock: Callable[[], float] = time.time) -> None:
        self._key = OctKey.import_key(secrets.token_bytes(32))
        self._clock = clock
        self._used: dict[str, float] = {}

    def start(self, back: str) -> tuple[Started, str]:
        state, nonce, verifier = (secrets.token_urlsafe(32) for _ in range(3))
        started = Started(state, nonce, verifier, back, self._clock() + PENDING_LIFETIME)
        return started, jwt.encode({"alg": "HS256"}, asdict(started), self._key)

    def finish(self, cookie: str, state: str) -> Started:
        """The sign-in of a cookie, if the provider returned its state, once. Raises `SignInError`."""
        try:
            started = Started(**jwt.decode(cookie, self._key, algorithms=["HS256"]).claims)
        except (JoseError, ValueError, TypeError):
            raise stale() from None
        at = self._clock()
        for old in [one for one, expires in self._used.items() if expires <= at]:
            del self._used[old]
        same = hmac.compare_digest(started.state.encode(), state.encode("utf-8", "surrogatepass"))
        if not same or started.expires <= at or started.state in self._used:
            raise stale()
        while len(self._used) >= MOST:
            del self._used[next(iter(self._used))]
        self._used[started.state] = started.expires
        return started
