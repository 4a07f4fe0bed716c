"""The process of live simulations, shared by all tests of a process; runs that make few evaluations again."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.given.live_process import Live
from worker.engine.stages.parts import encounter, offered
from worker.evidence.audit import judge, limits

FEW, OTHERS = 5, 10


@pytest.fixture(autouse=True, scope="module")
def few_checks(request: pytest.FixtureRequest) -> Iterator[None]:
    """Check five evaluations with the reference integrator instead of 200, two thirds of a run's processor time.
    Besides the sample, simulate ten beyond the horizon instead of 1,000, which is half of what is left.

    A module with `ALL_CHECKS` has all of them.
    """
    if getattr(request.module, "ALL_CHECKS", False):
        yield
        return
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(offered, "SPOT_CHECKS", FEW)
        patch.setattr(encounter, "OTHERS", OTHERS)
        patch.setattr(limits, "OTHERS", OTHERS)
        patch.setattr(judge.audit, "__defaults__", (offered.AT_MOST, FEW))
        yield


@pytest.fixture(scope="session")
def live() -> Iterator[Live]:
    made = Live()
    assert made.hear() == {"ready": True}
    yield made
    assert made.end() == (0, b"")
