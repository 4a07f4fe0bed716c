"""The picture of the README is what its tool draws of its campaign."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from clearance.cli import invoke
from tools import picture

REPOSITORY = Path(__file__).parents[2]


def words(drawn: str) -> list[str]:
    return re.findall(r"<(?:text|title)[^>]*>([^<]*)", drawn)


@pytest.mark.nightly
def test_it_is_drawn_again(tmp_path: Path) -> None:
    campaign = REPOSITORY / "campaigns/library/unicycle_navigation.yaml"
    invoke(["run", str(campaign), "--out", str(tmp_path / "run"), "--data", str(tmp_path / "data")])
    picture.main(tmp_path / "run", tmp_path / "picture.svg")
    drawn = (tmp_path / "picture.svg").read_text(encoding="utf-8")
    stored = (REPOSITORY / "docs/images/worst-case.svg").read_text(encoding="utf-8")
    assert words(drawn) == words(stored)
    assert len(drawn) == pytest.approx(len(stored), rel=0.01), "coordinates may differ in their last digit"
