"""Signing in, accepting invitations and changing passwords, each with its row in the audit trail."""

from __future__ import annotations

from dataclasses import dataclass

import sqlalchemy as sa

from backend.db import access, audit, identities, passwords, users
from backend.db.access import Visitor
from backend.db.engine import read
from backend.db.roles import LOCAL
from backend.http.errors import RefusedError
from backend.sessions.failures import UNKNOWN
from campaigns import Problem


@dataclass(frozen=True)
class Browser:
    agent: str
    address: str


def open_by_link(engine: sa.Engine, code: str, browser: Browser) -> str | None:
    """Use a login code; the secret of a new session, None if the code is wrong, used or expired."""
    with engine.begin() as writer:
        if not access.use_login_code(writer, code):
            return None
        return _opened(writer, LOCAL, "link", browser)


def open_by_password(engine: sa.Engine, name: str, browser: Browser) -> str | None:
    """Open a session for a user whose password was right; None if access was withdrawn in the meantime."""
    with engine.begin() as writer:
        if users.password_of(writer, name) is None:
            return None
        return _opened(writer, name, "password", browser)


def accept(engine: sa.Engine, code: str, password: str, browser: Browser) -> str | None:
    """Use an invitation; the secret of a new session, None if it is not valid."""
    hashed = passwords.hashed(password)
    with engine.begin() as writer:
        invited = users.invited(writer, code)
        again = invited is not None and users.has_joined(writer, invited)
        name = users.accept(writer, code, hashed)
        if name is None:
            return None
        action = "user.password_set" if again else "user.joined"
        return _opened(writer, name, "password", browser, action)


def note_failure(engine: sa.Engine, name: str, failures: int, address: str) -> None:
    """Record a failed sign-in, with the name only if a user has it: what was typed there may be a password."""
    with engine.begin() as writer:
        known = name if users.role_of(writer, name) is not None else UNKNOWN
        detail = {"address": address, "failures": failures}
        audit.note_sign_in(writer, known, "password", "session.failed", detail)


def close(engine: sa.Engine, secret: str, visitor: Visitor) -> None:
    with engine.begin() as writer:
        user = access.close_session(writer, secret)
        if user is not None:
            audit.note(writer, visitor, "session.closed", user, {})


def revoke(engine: sa.Engine, session_id: str, visitor: Visitor) -> None:
    """Sign another browser out; 404 if there is no such session of this user, or of any for administrators."""
    with engine.begin() as writer:
        user = access.revoke_session(writer, session_id, None if visitor.sees_all else visitor.account)
        if user is None:
            raise RefusedError("not-found", f"there is no open session {session_id[:40]!r}")
        audit.note(writer, visitor, "session.revoked", user, {"session": session_id})


def change_password(engine: sa.Engine, current: str | None, new: str, visitor: Visitor) -> None:
    """Change the visitor's own password and sign out their other browsers. 403 if the current one is wrong."""
    with read(engine) as reader:
        stored = users.password_of(reader, visitor.account)
        provided = identities.is_provided(users.creator_of(reader, visitor.account) or "")
    if provided:
        raise RefusedError("wrong-password", "you sign in through the provider: change your password there")
    if stored is not None and not passwords.matches(stored, current or ""):
        raise RefusedError("wrong-password", "the current password is wrong: nothing was changed")
    problem = passwords.problem(new, visitor.account)
    if problem is not None:
        raise RefusedError("invalid-request", problem, [Problem("new", "", problem)])
    hashed = passwords.hashed(new)
    with engine.begin() as writer:
        users.set_password(writer, visitor.account, hashed, visitor.key)
        audit.note(writer, visitor, "user.password_changed", visitor.account, {})


def _opened(writer: sa.Connection, user: str, via: str, browser: Browser, *before: str) -> str:
    """Open a session; before: the actions that are recorded before that one. Recording comes last, see `audit`."""
    secret = access.open_session(writer, user, via, browser.agent, browser.address)
    for action in (*before, "session.opened"):
        audit.note_sign_in(writer, user, via, action, {"address": browser.address})
    return secret
