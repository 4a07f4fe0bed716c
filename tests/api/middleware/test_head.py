"""HEAD works at every address that supports GET, and changes nothing."""

from __future__ import annotations

from pathlib import Path

import httpx
import pytest

from backend.scenes.recordings import recording
from tests.given.finished_runs import finish
from tests.given.service import Service, until
from tests.given.submissions import submit
from tests.given.viewer_clients import KEY


def head_and_get(client: httpx.Client, path: str) -> None:
    """HEAD returns the headers of GET, and no body."""
    with client.stream("GET", path, follow_redirects=False) as got:
        head = client.head(path)
        assert (head.status_code, head.content) == (got.status_code, b""), path
        names = ["content-type", "content-length", "etag", "location", "content-security-policy"]
        if path.endswith((".pdf", ".html", "/workers")) or "/requirements/export/" in path:
            names.remove("content-length")  # answered twice, with the present time in it, which packs differently
        for name in names:
            assert head.headers.get(name) == got.headers.get(name), (path, name)


def test_head_is_answered_at_every_address_that_answers_get(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))  # no Chromium: a report that is printed twice is not the same file
    monkeypatch.setattr(recording, "RATE", 0.2)  # few frames: making a recording takes a second otherwise
    run = submit(client)
    finish(service)
    values = {"run": run, "flight": "F1", "name": "F1", "draft": "1", "key": KEY, "sweep": "S-0001", "user": "local"}
    values |= {"finding": "F1", "file": "1"}
    paths = [path for path, kinds in service.app.openapi()["paths"].items() if "get" in kinds]
    assert len(paths) > 20
    for path in [*paths, "/", "/runs", f"/view/{run}/", f"/view/{run}", f"/view/{run}/F1/recorded/", "/login"]:
        head_and_get(client, path.format(**values))
    until(lambda: service.app.state.hub.listeners == 0)
    with service.visitor() as stranger:
        head_and_get(stranger, "/api/v1/runs")
    head_and_get(client, f"/api/v1/runs/{run}/restore")


def test_head_does_not_use_a_login_link_up(service: Service) -> None:
    link = f"/login?code={service.login_code()}"
    with service.visitor() as browser:
        assert browser.head(link).status_code == 200
        assert "set-cookie" not in browser.head(link).headers
        assert browser.get(link).status_code == 303
