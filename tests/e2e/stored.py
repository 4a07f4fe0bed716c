"""A service with the built pages and no worker, for tests of stored runs."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from backend.scenes.base.schemas import Layers, ViewState
from backend.scenes.live.live import Live
from backend.settings import Settings
from tests.given.service import Service
from tests.migrated import migrated

VIEW = ViewState(
    opened=1.0,
    revision=1,
    flight="F1",
    time=10.0,
    horizon=40.0,
    camera="chase",
    eye=None,
    playing=False,
    speed=1.0,
    theme="light",
    panel=False,
    layers=Layers(
        nominal=True,
        finding=True,
        what_if=False,
        velocity=True,
        relative=False,
        trail="whole",
        sampled=False,
        field=False,
    ),
    what_if=None,
    what_if_seed=None,
).model_dump(mode="json")
"""What an open 3D view would answer."""


@contextmanager
def served(data: Path, catalogue: dict[str, Any] | None = None, **given: Any) -> Iterator[Service]:
    """A running service on an empty folder, with a catalogue, by default that of the API's tests. given: settings."""
    migrated(data)
    with opened(data, **given) as service:
        service.publish(catalogue)
        yield service


@contextmanager
def opened(data: Path, **given: Any) -> Iterator[Service]:
    """A running service on a folder with a database. given: more settings."""
    settings = Settings(data=data, pages=Settings.load().pages, **given)
    assert (settings.pages / "index.html").is_file(), "the pages are not built: make install"
    service = Service(settings, given.get("port", 0))
    service.app.state.live = live = Live(first_limit=120.0)  # it waits while a cold cache compiles
    service.start()
    try:
        yield service
    finally:
        live.close()
        if service.running:
            service.stop()
