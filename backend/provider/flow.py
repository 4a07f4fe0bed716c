"""The authorization code flow with PKCE, state and nonce, and the checks of the ID token.

OpenID Connect Core 1.0, section 3.1; RFC 7636; RFC 9207; RFC 9700.
"""

from __future__ import annotations

import asyncio
import urllib.parse
from collections.abc import Mapping

from authlib.oauth2.rfc6749.parameters import prepare_grant_uri
from authlib.oauth2.rfc7636 import create_s256_code_challenge
from authlib.oidc.core import CodeIDToken
from joserfc import jwt
from joserfc.errors import InvalidKeyIdError, JoseError

from backend.provider.configuration import Configured, Identity, safe_address
from backend.provider.documents import Documents, fetch
from backend.provider.errors import SignInError, invalid
from backend.provider.pending import Pending, Started

ALGORITHMS = ["RS256", "RS384", "RS512", "PS256", "PS384", "PS512", "ES256", "ES384", "ES512", "EdDSA"]
"""Accepted signatures: asymmetric ones only, never `none`, and never HMAC with what may be a public key."""

SKEW = 60
"""How far the clocks of service and provider may differ [s]."""

AT_ONCE = 8
"""Sign-ins for which the provider is asked at the same time."""

LONGEST = 255
"""Maximum length of a subject [characters] (OpenID Connect Core 1.0, section 2)."""


class Provider:
    """Signs users in through one provider; used on one event loop."""

    def __init__(self, configured: Configured) -> None:
        self.configured = configured
        self.pending = Pending()
        self._documents = Documents(configured)
        self._inside = 0
        self._lock = asyncio.Lock()

    async def begin(self, back: str) -> tuple[str, str]:
        """The provider's address to which the browser is sent, and the cookie of this sign-in."""
        async with self._lock:  # of many clients at the start, one fetches the configuration
            metadata = await self._documents.metadata()
        started, cookie = self.pending.start(back)
        address = prepare_grant_uri(
            str(metadata["authorization_endpoint"]),
            self.configured.client_id,
            "code",
            self.configured.redirect,
            self.configured.scopes,
            started.state,
            nonce=started.nonce,
            code_challenge=create_s256_code_challenge(started.verifier),
            code_challenge_method="S256",
        )
        return address, cookie

    async def finish(self, answer: Mapping[str, str], cookie: str) -> tuple[Identity, str]:
        """Who signed in, and where the sign-in leads. Raises `SignInError`."""
        started = self.pending.finish(cookie, answer.get("state", ""))
        name = self.configured.name
        if answer.get("iss", self.configured.issuer) != self.configured.issuer:
            raise invalid(name, "another issuer")
        if "error" in answer:
            raise _denied(name, answer["error"])
        if not answer.get("code"):
            raise invalid(name, "no code")
        if self._inside >= AT_ONCE:
            raise SignInError("Many users are signing in at the same time. Sign in again in a few seconds.", 503)
        self._inside += 1
        try:
            return await self._identity(answer["code"], started), started.back
        finally:
            self._inside -= 1

    async def _identity(self, code: str, started: Started) -> Identity:
        tokens = await self._exchanged(code, started.verifier)
        claims = await self._verified(tokens, started.nonce)
        wanted = self.configured.groups_claim
        if wanted not in claims:
            claims = {**await self._more(tokens, str(claims["sub"])), **claims}
        called = (claims.get("preferred_username"), claims.get("email"), claims.get("name"))
        name = next((one for one in called if isinstance(one, str) and one), "")
        return Identity(self.configured.issuer, str(claims["sub"]), name, _listed(claims.get(wanted)))

    async def _exchanged(self, code: str, verifier: str) -> dict[str, object]:
        """The tokens for a code; the secret is sent as the provider prefers (RFC 6749, 2.3.1)."""
        of, metadata = self.configured, await self._documents.metadata()
        form = {"grant_type": "authorization_code", "code": code, "redirect_uri": of.redirect}
        form["code_verifier"] = verifier
        methods = metadata.get("token_endpoint_auth_methods_supported")
        if of.secret and (not isinstance(methods, list) or not methods or "client_secret_basic" in methods):
            quoted = (urllib.parse.quote(of.client_id, safe=""), urllib.parse.quote(of.secret, safe=""))
            return await fetch(of.name, "POST", str(metadata["token_endpoint"]), data=form, auth=quoted)
        form["client_id"] = of.client_id
        if of.secret:
            form["client_secret"] = of.secret
        return await fetch(of.name, "POST", str(metadata["token_endpoint"]), data=form)

    async def _verified(self, tokens: dict[str, object], nonce: str) -> dict[str, object]:
        """The claims of the ID token: signature, issuer, audience, times, nonce and subject are checked."""
        of, text = self.configured, tokens.get("id_token")
        if not isinstance(text, str):
            raise invalid(of.name, "no ID token")
        try:
            try:
                token = jwt.decode(text, await self._documents.keys(), algorithms=ALGORITHMS)
            except InvalidKeyIdError:
                token = jwt.decode(text, await self._documents.keys(fresh=True), algorithms=ALGORITHMS)
            options = {
                "iss": {"essential": True, "value": of.issuer},
                "aud": {"essential": True, "value": of.client_id},
                "exp": {"essential": True},
                "iat": {"essential": True},
            }
            known = {"nonce": nonce, "client_id": of.client_id, "access_token": tokens.get("access_token")}
            claims = CodeIDToken(token.claims, token.header, options, known)
            claims.validate(leeway=SKEW)
        except JoseError as error:
            raise invalid(of.name, _statement(error)) from None
        except (ValueError, TypeError, AttributeError, KeyError):
            raise invalid(of.name, "malformed ID token") from None
        subject = claims["sub"]
        if not isinstance(subject, str) or not 0 < len(subject) <= LONGEST:
            raise invalid(of.name, "invalid subject")
        return dict(claims)

    async def _more(self, tokens: dict[str, object], subject: str) -> dict[str, object]:
        """The claims that only the UserInfo endpoint has; those of another subject are refused (section 5.3.2)."""
        address = str((await self._documents.metadata()).get("userinfo_endpoint") or "")
        token = tokens.get("access_token")
        if not safe_address(address) or not isinstance(token, str):
            return {}
        found = await fetch(self.configured.name, "GET", address, headers={"Authorization": f"Bearer {token}"})
        if found.get("sub") != subject:
            raise invalid(self.configured.name, "user information of another subject")
        return found


def _listed(groups: object) -> tuple[str, ...]:
    """Groups as providers send them: a list, or one name."""
    if isinstance(groups, str):
        return (groups,)
    return tuple(one for one in groups if isinstance(one, str)) if isinstance(groups, list) else ()


def _denied(name: str, error: str) -> SignInError:
    if error in ("access_denied", "consent_required", "login_required", "interaction_required"):
        return SignInError(f"{name} did not sign you in: it reports that access was denied.", 403, "denied")
    shown = error[:60] if error.isascii() and error.isprintable() else "an invalid error"
    return SignInError(f"{name} did not sign you in: it reports {shown!r}. Try again.", 403, shown)


def _statement(error: JoseError) -> str:
    """What a check of a token found, without anything from the token itself."""
    claim = getattr(error, "claim", None)
    return f"{error.error.replace('_', ' ')}{f': {claim}' if isinstance(claim, str) else ''}"
