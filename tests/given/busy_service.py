"""A service with a finished run, a draft and a stand-in simulation process, to which anything may be sent."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from backend.previews.service import Previews
from backend.scenes.live.live import Live
from backend.scenes.recordings import recording
from tests.api.conftest import Fresh, running
from tests.given.finished_runs import finish
from tests.given.service import Service
from tests.given.stand_in_simulation import FLYING, STAND_IN
from tests.given.submissions import submit


@contextmanager
def occupied(fresh: Fresh, folder: Path, **settings: Any) -> Iterator[Service]:
    """The service; its runs are R-0001, which has ended, and R-0002, its draft D-0001. Its recordings have few frames:
    what is in one is tested in test_recordings.py."""
    (folder / "dist" / "assets").mkdir(parents=True)  # a folder that is not there has no names that are too long
    with pytest.MonkeyPatch.context() as patch, running(fresh, folder, **settings) as service:
        patch.setattr(recording, "RATE", 0.2)
        service.publish()
        live = Live((sys.executable, "-c", STAND_IN), limit=10, first_limit=10)
        service.app.state.previews = Previews(live)
        service.app.state.live = Live((sys.executable, "-c", FLYING), limit=10, first_limit=10)
        with service.signed_in() as client:
            submit(client)
            finish(service)
            submit(client, seed=2)
            client.post("/api/v1/drafts", json={"name": "", "text": "name:"})
        yield service
