"""The pauses after failed sign-ins, with a clock of the test: nothing here depends on time."""

from __future__ import annotations

from backend.sessions import lockout as module
from backend.sessions.lockout import ACCOUNT, ADDRESS, FORGOTTEN, Lockout, seconds


class Clock:
    def __init__(self) -> None:
        self.now = 1000.0

    def __call__(self) -> float:
        return self.now


def failing(lockout: Lockout, clock: Clock, name: str, times: int, address: str = "10.0.0.1") -> list[float]:
    """Fail so often, each time as soon as it is permitted; the pauses that were necessary."""
    waits = []
    for _ in range(times):
        wait = lockout.enter(name, address)
        waits.append(wait)
        if wait:
            clock.now += wait
            assert lockout.enter(name, address) == 0
    return waits


def test_the_pauses_of_an_account_double_up_to_a_quarter_of_an_hour() -> None:
    clock = Clock()
    lockout = Lockout(clock)
    waits = [failing(lockout, clock, "ada", 1, f"10.0.{i}.1")[0] for i in range(18)]
    assert waits[: ACCOUNT.free] == [0] * ACCOUNT.free
    assert waits[ACCOUNT.free :] == [min(2.0**i, 900.0) for i in range(18 - ACCOUNT.free)]


def test_other_accounts_at_other_addresses_are_not_concerned() -> None:
    clock = Clock()
    lockout = Lockout(clock)
    failing(lockout, clock, "ada", ACCOUNT.free)
    assert lockout.enter("ada", "10.0.0.9") > 0
    assert lockout.enter("bob", "10.0.0.9") == 0


def test_an_address_that_tries_many_names_pauses_for_at_most_a_minute() -> None:
    clock = Clock()
    lockout = Lockout(clock)
    waits = [failing(lockout, clock, f"name{i}", 1)[0] for i in range(ADDRESS.free + 9)]
    assert waits[: ADDRESS.free] == [0] * ADDRESS.free
    assert waits[ADDRESS.free :] == [1, 2, 4, 8, 16, 32, 60, 60, 60]


def test_attempts_at_the_same_time_do_not_pass_together() -> None:
    clock = Clock()
    lockout = Lockout(clock)
    assert [lockout.enter("ada", "10.0.0.1") > 0 for _ in range(50)].count(False) == ACCOUNT.free


def test_an_attempt_during_a_pause_does_not_prolong_it() -> None:
    clock = Clock()
    lockout = Lockout(clock)
    failing(lockout, clock, "ada", ACCOUNT.free)
    first = lockout.enter("ada", "10.0.0.1")
    assert [lockout.enter("ada", "10.0.0.1") for _ in range(100)] == [first] * 100


def test_success_forgets_the_failures_of_the_account_but_not_those_of_the_address() -> None:
    clock = Clock()
    lockout = Lockout(clock)
    for i in range(ADDRESS.free - 1):
        assert lockout.enter(f"name{i}", "10.0.0.1") == 0
    assert lockout.enter("ada", "10.0.0.1") == 0
    lockout.succeeded("ada", "10.0.0.1")
    assert lockout.failures("ada") == 0
    assert lockout.enter("eve", "10.0.0.1") == 0, "the right password was no failure"
    assert lockout.enter("eve", "10.0.0.1") > 0, "those before it still count"


def test_an_attempt_whose_password_was_not_compared_is_none() -> None:
    clock = Clock()
    lockout = Lockout(clock)
    failing(lockout, clock, "ada", ACCOUNT.free - 1)
    for _ in range(ADDRESS.free):
        assert lockout.enter("ada", "10.0.0.1") == 0
        lockout.not_compared("ada", "10.0.0.1")
    assert lockout.failures("ada") == ACCOUNT.free - 1


def test_failures_are_forgotten_after_an_hour() -> None:
    clock = Clock()
    lockout = Lockout(clock)
    failing(lockout, clock, "ada", ACCOUNT.free)
    clock.now += FORGOTTEN + 1
    assert lockout.enter("ada", "10.0.0.1") == 0
    assert lockout.failures("ada") == 1


def test_addresses_of_one_ipv6_network_count_together() -> None:
    lockout = Lockout(Clock())
    tried = [lockout.enter(f"name{i}", f"2001:db8::{i:x}") for i in range(ADDRESS.free + 1)]
    assert tried[-1] > 0
    assert lockout.enter("bob", "2001:db8:0:1::1") == 0


def test_the_memory_is_bounded() -> None:
    lockout = Lockout(Clock())
    for i in range(module.MOST + 10):
        lockout.enter(f"name{i}", "")
        lockout._counts.pop(("address", ""), None)
    assert len(lockout._counts) <= module.MOST


def test_a_wait_is_stated_in_whole_seconds() -> None:
    assert [seconds(wait) for wait in (0.01, 1.0, 1.2)] == [1, 1, 2]
