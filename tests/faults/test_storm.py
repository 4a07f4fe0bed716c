"""Storms by night: nothing lost, repeated, left behind or given up. `make faults` has all, on both databases."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path

import pytest

from backend.db.engine import default_url
from tests.storm.faults import FAULTS
from tests.storm.faults.base import hurt, kernels
from tests.storm.faults.disks import small
from tests.storm.kills import storm
from tests.storm.site import site

pytestmark = pytest.mark.nightly


@pytest.mark.timeout(400)
@pytest.mark.parametrize("name", FAULTS)
def test_nothing_is_lost_by_a_fault(tmp_path: Path, name: str) -> None:
    fault = FAULTS[name]
    disk = small(tmp_path) if fault.disk else nullcontext()
    with disk, kernels(tmp_path / "kernels"), site(default_url(tmp_path), tmp_path) as made:
        row = hurt(made, "sqlite", name, fault)
    assert (row.lost, row.repeated, row.left_behind, row.given_up) == (0, 0, 0, 0), row


@pytest.mark.timeout(1200)
def test_nothing_is_lost_in_a_storm(tmp_path: Path) -> None:
    with site(default_url(tmp_path), tmp_path) as made:
        row = storm(made, "sqlite", 4)
    assert (row.lost, row.repeated, row.left_behind, row.given_up) == (0, 0, 0, 0), row
