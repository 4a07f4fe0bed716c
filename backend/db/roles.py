"""Roles of users and scopes of API tokens, each from the least to the most; the one place of their order."""

from __future__ import annotations

from typing import Literal, get_args

Role = Literal["viewer", "engineer", "reviewer", "admin"]
"""viewer reads; engineer also launches, cancels and edits their own; reviewer also signs off; admin does everything."""

Scope = Literal["read", "run", "admin"]
"""read: what a viewer may; run: what an engineer may; admin: everything that the token's owner may."""

LOCAL = "local"
"""The user of every login link: an administrator from the first start, because a link is made on the machine itself."""

ROLES: tuple[Role, ...] = get_args(Role)
SCOPES: tuple[Scope, ...] = get_args(Scope)

_SCOPE_OF: dict[Role, Scope] = {"viewer": "read", "engineer": "run", "reviewer": "run", "admin": "admin"}


def has_role(role: Role, least: Role) -> bool:
    return ROLES.index(role) >= ROLES.index(least)


def has_scope(scope: Scope, least: Scope) -> bool:
    return SCOPES.index(scope) >= SCOPES.index(least)


def widest(role: Role) -> Scope:
    """The widest scope of a token that a user of this role may create."""
    return _SCOPE_OF[role]
