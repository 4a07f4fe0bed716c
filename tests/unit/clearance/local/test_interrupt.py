"""Ctrl-C and SIGTERM, also while a callback swallows exceptions."""

from __future__ import annotations

import gc
import signal
import weakref

import pytest

from clearance.local import interrupt


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
