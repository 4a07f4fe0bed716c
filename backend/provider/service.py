"""Opens a session for a user of the provider, with the role of the groups, each with its row in the audit trail."""

from __future__ import annotations

import sqlalchemy as sa

from backend.db import access, audit, identities
from backend.db.access import PROVIDER_SESSION_LIFETIME
from backend.db.identities import SignedIn
from backend.db.roles import Role
from backend.provider.configuration import Identity
from backend.provider.errors import SignInError
from backend.sessions.failures import UNKNOWN
from backend.sessions.service import Browser

VIA = "provider"


def open_session(engine: sa.Engine, identity: Identity, role: Role | None, browser: Browser) -> str:
    """The secret of a new session. Raises `SignInError` if the groups give no role or the user is disabled."""
    key = identities.identity_of(identity.issuer, identity.subject)
    if role is None:
        raise _withdrawn(engine, key, browser)
    try:
        opened = _opened(engine, identity, key, role, browser)
    except sa.exc.IntegrityError:  # the same user signs in for the first time in two browsers
        opened = _opened(engine, identity, key, role, browser)
    if opened is None:
        raise SignInError("Your access was withdrawn. Ask an administrator.", 403)
    return opened


def note_failure(engine: sa.Engine, reason: str, address: str) -> None:
    """Record a sign-in that failed before there was a user."""
    with engine.begin() as writer:
        audit.note_sign_in(writer, UNKNOWN, VIA, "session.failed", {"address": address, "reason": reason[:200]})


def _opened(engine: sa.Engine, identity: Identity, key: str, role: Role, browser: Browser) -> str | None:
    with engine.begin() as writer:
        signed = identities.sign_in(writer, key, identity.name, role)
        if signed is None:
            found = identities.user_of(writer, key)
            detail = {"address": browser.address, "reason": "disabled"}
            audit.note_sign_in(writer, UNKNOWN if found is None else found.name, VIA, "session.failed", detail)
            return None
        secret = access.open_session(
            writer, signed.name, VIA, browser.agent, browser.address, PROVIDER_SESSION_LIFETIME
        )
        for action, change in _changes(signed, identity):
            audit.note_sign_in(writer, signed.name, VIA, action, change)
        audit.note_sign_in(writer, signed.name, VIA, "session.opened", {"address": browser.address})
        return secret


def _changes(signed: SignedIn, identity: Identity) -> list[tuple[str, dict[str, object]]]:
    if signed.before is None:
        who: dict[str, object] = {"role": signed.role, "issuer": identity.issuer, "subject": identity.subject}
        return [("user.joined", who)]
    if signed.before != signed.role:
        return [("user.role_changed", {"before": signed.before, "after": signed.role})]
    return []


def _withdrawn(engine: sa.Engine, key: str, browser: Browser) -> SignInError:
    sentence = (
        "None of your groups has access to Clearance. Ask an administrator to give one of them a role; "
        "then sign in again."
    )
    with engine.begin() as writer:
        ended = identities.withdraw(writer, key)
        name, ended_access = (UNKNOWN, {}) if ended is None else ended
        if ended is not None and (ended_access["sessions"] or ended_access["tokens"]):
            audit.note_sign_in(
                writer, name, VIA, "user.access_ended", {"reason": "no group has a role", **ended_access}
            )
        detail = {"address": browser.address, "reason": "no group has a role"}
        audit.note_sign_in(writer, name, VIA, "session.failed", detail)
    return SignInError(sentence, 403)
