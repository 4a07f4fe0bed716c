"""Whole numbers and choices, as the guide varies them: every choice has the same fraction, and none is outside."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest

REPOSITORY = Path(__file__).parents[4]
DOCS = REPOSITORY / "docs"
GUIDES = ("your-own-simulator.md", "first-campaign.md", "methods.md")


@pytest.fixture(scope="module")
def example() -> dict[str, Any]:
    """What the example of the guide defines when it is run."""
    blocks = re.findall(r"```python\n(.*?)```", (DOCS / "python.md").read_text(encoding="utf-8"), re.DOTALL)
    (text,) = [block for block in blocks if "def chosen(" in block]
    space: dict[str, Any] = {}
    exec(text, space)
    return space


@pytest.mark.parametrize("choices", range(1, 9))
def test_every_choice_has_the_same_fraction_of_the_range(example: dict[str, Any], choices: int) -> None:
    low, high = -0.5, choices - 0.5
    middles = low + (np.arange(1000 * choices) + 0.5) / 1000
    counts = Counter(example["chosen"](float(value), choices) for value in middles)
    assert counts == dict.fromkeys(range(choices), 1000)
    assert [example["chosen"](value, choices) for value in (low, high)] == [0, choices - 1]


def test_the_example_finds_the_worst_choice_and_evaluates_all(example: dict[str, Any]) -> None:
    found, modes = example["chosen_worst"], example["MODES"]
    assert example["ranges"]["mode"] == (-0.5, len(modes) - 0.5)
    searched = found.points[found.stage == "certify"][:, 0] if (found.stage == "certify").any() else found.points[:, 0]
    assert {example["chosen"](float(value), len(modes)) for value in searched} == {0, 1, 2}
    assert found.costs.min() < 2.0
    assert example["chosen"](found.points[int(np.nanargmin(found.costs))][0], len(modes)) == modes.index("climb")


@pytest.mark.parametrize("name", GUIDES)
def test_the_other_guides_refer_to_it(name: str) -> None:
    assert "(python.md#whole-numbers-and-choices)" in (DOCS / name).read_text(encoding="utf-8")
