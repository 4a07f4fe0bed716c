"""Every campaign of the library flies 200 random points at its step and at half of it.

Passes when none differs beyond the campaign's tolerance, or no more than its notes say ("Step adequacy: up to ...", see
`worker.reproduce.steps`).
"""

from __future__ import annotations

import pytest

from campaigns import library, load_file
from worker.problem import Problem
from worker.reproduce.steps import adequacy, sentence


@pytest.mark.parametrize("name", library())
def test_half_the_step(name: str) -> None:
    problem = Problem(load_file(library()[name]))
    found = adequacy(name, problem)
    assert found.ok, sentence(found)
    if found.declared is not None:
        many = adequacy(name, problem, 10_000)
        assert many.ok, sentence(many)
        assert many.exceeding + many.differing > 0, "its notes allow for what no longer happens: correct them"
