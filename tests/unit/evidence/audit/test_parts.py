"""Parts of a record made again: only the fields that follow, in their order, without validation."""

from __future__ import annotations

import math
from typing import Any

import pytest

from campaigns.results.sample import Beside, Blocks, GridPoint, GridResult
from worker.evidence.audit.parts import OMIT, REST, Counts, changed, made, read, written


def test_only_the_fields_that_follow_are_written_in_the_order_of_the_call() -> None:
    lowest = made(GridPoint, margin=math.inf, cost=1.0, **REST)
    grid = made(GridResult, violations=2, points=3, lowest=lowest, statement=OMIT, **REST)
    assert list(written(grid)) == ["violations", "points", "lowest"]
    assert list(written(changed(grid, excluded=1, points=OMIT))) == ["violations", "lowest", "excluded"]
    assert written([grid, Counts(1, 2, 3)])[1] == {"evaluations": 1, "failed": 2, "excluded": 3}
    assert written(grid)["lowest"] == {"margin": math.inf, "cost": 1.0}


def test_a_field_that_no_form_has_is_an_error() -> None:
    with pytest.raises(KeyError, match="spaces"):
        changed(made(GridResult, **REST), spaces=1)


def test_what_is_stored_is_read_as_it_is() -> None:
    stored: dict[str, Any] = {"draws": ["many"], "unknown": 1}
    blocks = read(Blocks, stored, beside=read(Beside, {}))
    assert blocks.draws == ["many"]
    assert blocks.lowest is None
    assert blocks.beside.flaky is None
