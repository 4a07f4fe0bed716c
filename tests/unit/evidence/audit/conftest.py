"""All tests here share stored runs, which were therefore all validated alike."""

from __future__ import annotations

import pytest

from worker.engine.stages.parts import offered
from worker.evidence.audit import judge


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fewer simulations with the reference integrator, as configured in the audit."""
    monkeypatch.setattr(offered, "SPOT_CHECKS", 2)
    monkeypatch.setattr(offered, "AT_MOST", 3)
    monkeypatch.setattr(judge.audit, "__defaults__", (judge.NOTHING, offered.AT_MOST, offered.SPOT_CHECKS))
