"""Passwords as Argon2id hashes (RFC 9106), with the parameters in the hash.

Source of the parameters and of the rules: OWASP Password Storage and Authentication Cheat Sheets; NIST SP 800-63B-4,
3.1.1.2: a minimum length, and no rules about kinds of characters.
"""

from __future__ import annotations

from functools import cache

from argon2 import PasswordHasher
from argon2.exceptions import InvalidHashError, VerificationError

SHORTEST, LONGEST = 12, 200
"""Minimum and maximum length of a password [characters]; the maximum limits the cost of hashing."""

_HASHER = PasswordHasher(time_cost=2, memory_cost=19 * 1024, parallelism=1)


def problem(password: str, name: str) -> str | None:
    """The reason why a password cannot be used, as a sentence that does not repeat it; None if it can."""
    if not SHORTEST <= len(password) <= LONGEST:
        return (
            f"a password has {SHORTEST} to {LONGEST} characters, given {len(password)}: several words make a good one"
        )
    if len(set(password)) < 5:
        return "this password repeats very few characters: several words make a good one"
    if name.lower() in password.lower() and len(password) - len(name) < SHORTEST:
        return "this password is little more than the user's name: choose another one"
    return None


def hashed(password: str) -> str:
    return _HASHER.hash(_bytes(password))


def matches(stored: str | None, password: str) -> bool:
    """Whether a password is that of the hash. Takes equally long if there is no hash: no oracle for accounts."""
    try:
        right = _HASHER.verify(stored or _decoy(), _bytes(password[: LONGEST + 1]))
    except (VerificationError, InvalidHashError):
        return False
    return right and bool(stored)


@cache
def _decoy() -> str:
    """The hash that is compared where there is none."""
    return _HASHER.hash(b"")


def _bytes(password: str) -> bytes:
    return password.encode("utf-8", "surrogatepass")
