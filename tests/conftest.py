"""In which order the files of tests are taken: those that need minutes first, so that all workers end together."""

from __future__ import annotations

import pytest

LONG = (
    "contract/test_components.py",
    "e2e/test_whole_way.py",
    "contract/test_methods.py",
    "e2e/test_browse.py",
    "faults/test_kill.py",
    "physics/test_uav_cases.py",
    "e2e/test_accessibility.py",
    "physics/test_criteria.py",
    "e2e/test_evidence.py",
    "physics/test_step_adequacy.py",
    "e2e/test_recording.py",
    "physics/test_faults.py",
    "e2e/test_new_user.py",
    "physics/test_realisations.py",
    "e2e/test_parameter_space.py",
    "faults/test_serve.py",
)
"""Browsers between compilations, which they disturb less than each other."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The long files first, all others as they come."""

    def turn(item: pytest.Item) -> int:
        path = item.path.as_posix()
        return next((i for i, name in enumerate(LONG) if path.endswith(name)), len(LONG))

    items.sort(key=turn)
