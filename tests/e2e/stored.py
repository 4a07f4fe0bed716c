"""A service on an empty folder, with the built pages and no worker, for tests of stored runs. Read `served`."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from backend.db.engine import default_url, migrate
from backend.settings import Settings
from tests.api.server import Service


@contextmanager
def served(data: Path, catalogue: dict[str, Any] | None = None) -> Iterator[Service]:
    """A running service with a catalogue, by default that of the API's tests."""
    settings = Settings(data=data, pages=Settings.load().pages)
    assert (settings.pages / "index.html").is_file(), "the pages are not built: make install"
    migrate(default_url(settings.data))
    service = Service(settings)
    service.start()
    service.publish(catalogue)
    yield service
    if service.running:
        service.stop()
