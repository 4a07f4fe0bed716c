"""The guide's campaign with a command in it states what the program beside it takes."""

from __future__ import annotations

import re
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[3]


def test_the_inline_campaign_has_the_parameters_and_results_of_its_program() -> None:
    guide = (ROOT / "docs" / "your-own-simulator.md").read_text(encoding="utf-8")
    block = re.search(r"```text\n(name: Parachute drop\nsimulator:.*?)```", guide, re.DOTALL)
    assert block is not None
    inline = yaml.safe_load(block[1])["simulator"]
    program = yaml.safe_load((ROOT / "docs" / "examples" / "drop" / "simulator.yaml").read_text(encoding="utf-8"))
    assert inline["parameters"].keys() == program["parameters"].keys()
    assert inline["results"].keys() <= program["results"].keys()
