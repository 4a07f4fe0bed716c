"""Ctrl-C and SIGTERM, also while a callback swallows exceptions."""

from __future__ import annotations

import gc
import signal
import weakref

import pytest

from campaigns import Campaign
from campaigns.stored.records import StagePlan
from clearance.local import interrupt
from tests.given.small_catalogue import campaign
from tests.given.ways_to_store import WAYS
from worker.running.runs.store import MemoryStore


class Thing:
    """Something to be finalised."""


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_an_interrupt_within_a_finaliser_is_not_lost() -> None:
    before = signal.getsignal(signal.SIGINT)
    with interrupt.deferred(lambda: False) as asked:
        assert asked() is False
        thing = Thing()
        kept = weakref.ref(thing, lambda _: signal.raise_signal(signal.SIGINT))
        del thing  # Python drops what a weak reference's callback raises
        gc.collect()
        assert kept() is None
        with pytest.raises(KeyboardInterrupt):
            asked()
    assert signal.getsignal(signal.SIGINT) is before


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_elsewhere_comes_at_once(number: signal.Signals) -> None:
    before = signal.getsignal(signal.SIGTERM)
    with interrupt.deferred(lambda: True, signal.SIGTERM) as asked:
        assert asked() is True
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(number)
    assert signal.getsignal(signal.SIGTERM) is before


@pytest.mark.parametrize("way", WAYS)
def test_an_interrupted_run_tells_of_all_that_it_evaluated(way: str) -> None:
    """Its number of evaluations and the lowest value, in whichever way they are stored."""
    store = MemoryStore()
    store.plan([StagePlan("nominal", None, 1), StagePlan("search", "direct", 10)])
    WAYS["in order"](store, 0, [0.9])

    def run() -> None:
        with interrupt.explained(store, Campaign.model_validate(campaign())):
            WAYS[way](store, 1, [0.8, 0.3, 0.7])
            raise KeyboardInterrupt

    with pytest.raises(interrupt.InterruptedRun) as told:
        run()
    assert told.value.lowest == interrupt.lowest(store) == 0.3
    assert str(told.value).split()[0] == "3"
