"""Whatever document is sent as a campaign, it is accepted or refused with a reason: in time, and in limited memory.

Mutated campaigns of the library; a few by day, 100,000 by night.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa

from backend.db.engine import connect
from backend.db.tables import CatalogueDocument
from backend.runs import submission
from backend.runs.address import AddressParts
from campaigns import CampaignError
from tests.adversary.mutations import GROWING, document
from tests.migrated import migrated
from worker.running.catalogue.installed import catalogue

LONGEST = 1.0
"""Processor time of one document at one door [s]."""

LARGEST = 300e6
"""Memory of the process that reads them, its own included [bytes]."""

BLOCKS, EACH = 20, 5000
FIRST = 1_000_000


def fuzzed(folder: Path, first: int, count: int) -> dict[str, Any]:
    """The measurement of a process of its own."""
    engine = connect(url := migrated(folder))
    values = {"id": 1, "document": catalogue().model_dump(mode="json"), "published": 1.0, "code": "0" * 64}
    with engine.begin() as writer:
        writer.execute(sa.insert(CatalogueDocument).values(**values))
    engine.dispose()
    command = [sys.executable, "-m", "tests.adversary.fuzzing", url, str(first), str(count)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def sound(found: dict[str, Any]) -> None:
    assert found["faults"] == [], [(fault["seed"], fault["door"], fault["error"]) for fault in found["faults"]]
    assert found["slowest"][0][0] < LONGEST, found["slowest"][0]
    assert found["peak"] < LARGEST


@pytest.mark.nightly  # by day tests/adversary/test_fuzzed_files.py
def test_mutated_documents_are_accepted_or_refused(tmp_path: Path) -> None:
    found = fuzzed(tmp_path, 0, 240)
    sound(found)
    outcomes = found["outcomes"]
    assert sum(outcomes.values()) == 240
    assert outcomes["accepted"] >= 20, "mutations that nobody accepts reach no check"
    assert outcomes["refused"] >= 100


@pytest.mark.nightly
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("block", range(BLOCKS))
def test_every_block_of_mutated_documents_is_accepted_or_refused(tmp_path: Path, block: int) -> None:
    sound(fuzzed(tmp_path, FIRST + block * EACH, EACH))


def test_a_document_is_found_again_by_its_seed() -> None:
    assert [document(seed) for seed in range(40)] == [document(seed) for seed in range(40)]
    assert len({document(seed) for seed in range(40)}) == 40
    assert len(GROWING) == 7


@pytest.mark.parametrize("body", [b"name: a\0b", b"# \0\nname: x", b"\0", b"name: x\n" + b"#" * 1_000_001])
def test_what_cannot_be_stored_is_refused_as_a_campaign(body: bytes) -> None:
    """It was stored as text before it was read, and ended in an internal error."""
    with pytest.raises(CampaignError):
        submission.from_yaml(body, AddressParts({}))
