"""The names to which the service answers."""

from __future__ import annotations

import pytest

from backend.middleware.hosts import Hosts

STRICT = Hosts("127.0.0.1", "https://clearance.example:8443/", "Lab lab.example", any_host=True)


@pytest.mark.parametrize(
    "host",
    [
        *("127.0.0.1", "127.0.0.1:8000", "localhost:9", "LOCALHOST", "[::1]:8000", "[::1]", "127.8.8.8", "localhost."),
        *("clearance.example", "clearance.example:8443", "CLEARANCE.example:1", "lab", "lab.example:80"),
    ],
)
def test_its_own_names_are_allowed(host: str) -> None:
    assert STRICT.allows(host)


@pytest.mark.parametrize(
    "host",
    [
        *("", "evil.example", "evil.example:8000", "127.0.0.1.evil.example", "localhost.evil.example", "[evil]:80"),
        *(
            "clearance.example.evil",
            "xclearance.example",
            "192.168.1.1",
            "0.0.0.0",
            "[::]",
            "2130706433",
            "*",
            "[",
            ":",
        ),
        *(":", "clearance.example@evil.example", "evil.example#clearance.example", "\xe9", "8.8.8.8:8000"),
        *("localhost:evil", "lab:80/x", "lab:", "localhost:80@evil.example", "lab lab", "[::1]x:80", "lab:1234567"),
    ],
)
def test_names_of_others_are_refused(host: str) -> None:
    assert not STRICT.allows(host)


def test_every_name_only_where_the_operator_said_so() -> None:
    assert Hosts("0.0.0.0", "", "", any_host=True).allows("10.0.0.7")
    assert not Hosts("127.0.0.1", "", "", any_host=False).allows("10.0.0.7")
    assert not Hosts("0.0.0.0", "https://a.example", "", any_host=True).allows("10.0.0.7")
    assert Hosts("0.0.0.0", "https://a.example", "*", any_host=True).allows("10.0.0.7")
    assert Hosts("192.168.1.5", "", "", any_host=False).allows("192.168.1.5:8000")


def test_a_name_with_a_port_is_allowed_with_that_port_only() -> None:
    hosts = Hosts("127.0.0.1", "", "lab.example:8443", any_host=True)
    assert [hosts.allows(f"lab.example{port}") for port in (":8443", ":80", "")] == [True, False, False]
