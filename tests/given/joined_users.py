"""Users for tests: invited by the administrator of the login link, joined by their link."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from contextlib import contextmanager

import httpx

from tests.given.service import Service

PASSWORD = "correct horse battery"
_NUMBERS = itertools.count(1)


def name(prefix: str) -> str:
    """A name that no other test uses."""
    return f"{prefix}-{next(_NUMBERS)}"


def invited(admin: httpx.Client, user: str, role: str) -> str:
    """The path of an invitation."""
    answer = admin.post("/api/v1/users", json={"name": user, "role": role})
    assert answer.status_code == 201, answer.text
    return str(answer.json()["path"])


def accept(client: httpx.Client, path: str, password: str = PASSWORD) -> httpx.Response:
    """Open an invitation and set the password."""
    assert client.get(path).status_code == 200
    code = path.partition("code=")[2]
    return client.post("/invite", data={"code": code, "password": password, "again": password})


def sign_in(client: httpx.Client, user: str, password: str = PASSWORD, back: str = "") -> httpx.Response:
    """Send the form of the sign-in page."""
    return client.post("/login", data={"name": user, "password": password, "next": back})


@contextmanager
def joined(service: Service, admin: httpx.Client, role: str) -> Iterator[tuple[str, httpx.Client]]:
    """A new user of that role, and their browser."""
    user = name(role)
    with service.visitor() as client:
        assert accept(client, invited(admin, user, role)).status_code == 303
        yield user, client
