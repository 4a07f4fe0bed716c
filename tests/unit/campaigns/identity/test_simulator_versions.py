"""The version of a simulator's declaration: the same after an edit of words, another one after every other edit."""

from __future__ import annotations

import hashlib

import pytest

from campaigns.catalogue import Catalogue
from tests.given.edited_declarations import EDITS, ENTRY, WORDS


def test_the_words_are_fields() -> None:
    assert set(EDITS) > WORDS


@pytest.mark.parametrize("field", EDITS)
def test_an_edit_of_words_alone_keeps_the_version(field: str) -> None:
    edited = EDITS[field]
    assert edited != ENTRY
    assert (edited.version == ENTRY.version) is (field in WORDS)
    assert edited.versions[1] not in ENTRY.versions


def test_a_run_of_an_earlier_version_needs_a_simulator_that_its_workers_state() -> None:
    digest = hashlib.sha256(ENTRY.model_dump_json().encode()).hexdigest()
    known = Catalogue(version="1", components=[], methods=[], simulators=[ENTRY])
    assert known.versions == [ENTRY.version, f"{ENTRY.name}@{digest[:16]}"]
    assert ENTRY.version != known.versions[1]
