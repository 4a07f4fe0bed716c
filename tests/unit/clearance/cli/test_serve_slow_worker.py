"""`clearance serve` while no worker starts in time: the service stays up, and says so."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from clearance.cli import INTERNAL, login_link, serve
from tests.migrated import migrated
from worker.running.processes.lifeline import Wakeup
from worker.running.processes.supervisor import START


@pytest.mark.parametrize("healthy", [True, False])
def test_the_service_stays_up_without_a_worker(
    tmp_path: Path, healthy: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    url = migrated(tmp_path)
    (tmp_path / login_link.ADDRESS_FILE).write_text("http://here")
    monkeypatch.setattr(serve, "PATIENCE", 0.2)
    monkeypatch.setattr(serve, "_answers", lambda address: healthy)
    serving = serve._Serving("127.0.0.1", 8000, tmp_path, url, 1, Wakeup())
    monkeypatch.setattr(serving.servers, "watch", lambda seconds: [])
    assert serving._wait_until_healthy(time.time()) == (None if healthy else INTERNAL)
    assert f"{'worker-1' if healthy else 'backend'}.log" in capsys.readouterr().out
    if healthy:
        serving._welcome(time.time())
        assert serve.MISSING in capsys.readouterr().out


def test_a_worker_process_that_is_late_is_tried_again(tmp_path: Path) -> None:
    """The service waits at least as long for it."""
    assert START <= serve.PATIENCE
