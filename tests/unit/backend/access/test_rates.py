"""The rate of requests of a session or token: a minute's requests at once, then evenly."""

from __future__ import annotations

from backend.access import rates
from backend.access.rates import Rates


class Clock:
    at = 0.0

    def __call__(self) -> float:
        return self.at


def test_a_minutes_requests_pass_at_once_and_the_next_after_a_wait() -> None:
    clock = Clock()
    bucket = Rates(60, clock)
    assert [bucket.wait("a") for _ in range(60)] == [0] * 60
    assert bucket.wait("a") == 1
    assert bucket.wait("a") == 1, "a refused request costs nothing"
    assert bucket.wait("b") == 0, "others are not concerned"
    clock.at = 1.0
    assert [bucket.wait("a"), bucket.wait("a")] == [0, 1]
    clock.at = 10_000.0
    assert [bucket.wait("a") for _ in range(61)] == [0] * 60 + [1]


def test_whoever_waits_as_stated_is_answered() -> None:
    clock = Clock()
    bucket = Rates(7, clock)
    for _ in range(7):
        assert bucket.wait("a") == 0
    clock.at += bucket.wait("a")
    assert bucket.wait("a") == 0


def test_the_memory_is_bounded() -> None:
    bucket = Rates(60, Clock())
    for number in range(rates.MOST + 50):
        bucket.wait(str(number))
    assert bucket._bucket.cache_info().currsize == rates.MOST
    assert bucket.wait(str(rates.MOST)) == 0, "of those that were used last none is forgotten"
