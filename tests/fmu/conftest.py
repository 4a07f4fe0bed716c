"""What tests of FMUs share."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from worker.running.catalogue.installed import forget_simulators


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The operator's folder, and a catalogue that is read again."""
    monkeypatch.setenv("CLEARANCE_SIMULATORS", str(tmp_path))
    forget_simulators()
    yield tmp_path
    forget_simulators()
