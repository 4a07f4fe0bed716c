"""Every search method describes itself, and its options have the effect stated in the catalogue."""

from __future__ import annotations

import pytest

from clearance.testing import methods as contract
from tests.contract.searches import EACH
from worker.engine.search.base import Method


@EACH
def test_it_is_documented(method: Method) -> None:
    contract.it_is_documented(method)


@EACH
def test_its_options_are_described(method: Method) -> None:
    contract.its_options_are_described(method)


@EACH
def test_its_options_pass_the_check_and_come_back(method: Method) -> None:
    contract.its_options_pass_the_check_and_come_back(method)


@pytest.mark.by_day(5)
@EACH
def test_whatever_the_check_lets_pass_the_method_takes(method: Method) -> None:
    contract.whatever_the_check_lets_pass_the_method_takes(method)


@pytest.mark.by_day(5)
@EACH
def test_any_option_that_passes_searches(method: Method) -> None:
    contract.any_option_that_passes_searches(method)


@pytest.mark.nightly  # by day the methods that options end, in tests/unit/campaigns/checked/test_expected.py
@EACH
def test_it_takes_at_least_what_is_announced(method: Method) -> None:
    contract.it_takes_at_least_what_is_announced(method)
