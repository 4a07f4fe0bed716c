"""Passwords: how they are stored, what matches, and which are refused."""

from __future__ import annotations

import pytest

from backend.db import passwords

GOOD = "correct horse battery"


def test_a_password_is_stored_as_argon2id_with_the_cost_that_was_decided_and_matches_only_itself() -> None:
    stored = passwords.hashed(GOOD)
    assert stored.startswith("$argon2id$v=19$m=19456,t=2,p=1$")
    assert len(stored) <= 200, "the column"
    assert passwords.matches(stored, GOOD)
    assert not passwords.matches(stored, GOOD + " ")


@pytest.mark.parametrize("stored", [None, "", "no hash", "$argon2id$v=19$m=19456,t=2,p=1$YWJj", "hash"])
def test_nothing_matches_where_there_is_no_hash(stored: str | None) -> None:
    assert not passwords.matches(stored, "")
    assert not passwords.matches(stored, GOOD)


def test_a_password_of_any_length_and_of_any_characters_is_compared_without_an_error() -> None:
    for strange in ("x" * 1_000_000, "\0", "\ud800", "é\u202e"):
        assert not passwords.matches(None, strange)


@pytest.mark.parametrize(
    "password", ["", "x" * 11, "abcdefghijk", "x" * 201, "abababababab", "grace.hopper1", "GRACE.HOPPER!"]
)
def test_a_weak_password_is_refused_without_repeating_it(password: str) -> None:
    statement = passwords.problem(password, "grace.hopper")
    assert statement
    assert len(password) < 5 or password not in statement


@pytest.mark.parametrize("password", [GOOD, "grace.hopper and the compiler", "ünïcödé wörds", "x1y2z3" * 30])
def test_a_long_enough_password_is_taken(password: str) -> None:
    assert passwords.problem(password, "grace.hopper") is None
