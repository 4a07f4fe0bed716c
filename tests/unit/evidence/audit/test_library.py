"""Runs of the shipped campaigns are audited as they are: what only some closed loops do is no forgery."""

from __future__ import annotations

import pytest

from campaigns import library, load_file
from campaigns.asked.load import load_document
from tests.audited import audited
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

pytestmark = pytest.mark.nightly

DAILY = "pioneer_moving"
"""Its loop chatters, so that the reference integrator has a value and a reason."""


@pytest.mark.parametrize(
    "name", [name if name == DAILY else pytest.param(name, marks=pytest.mark.nightly) for name in library()]
)
def test_a_run_of_a_shipped_campaign_follows_from_what_it_stored(name: str) -> None:
    document = load_file(library()[name]).document()
    kept = {key: document["stages"][key] for key in ("findings", "validate") if key in document["stages"]}
    searches = [{"method": "monte_carlo", "evaluations": 40}, {"method": "direct", "evaluations": 40}]
    campaign = load_document(document | {"stages": kept | {"search": searches, "sensitivity": None, "certify": None}})
    store = MemoryStore()
    execute(campaign, store, threads=1)
    audited(store, campaign)
    if name == DAILY:
        assert store.findings[0].validation.integrator.reason
        assert store.findings[0].validation.integrator.cost is not None
