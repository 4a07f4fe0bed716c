"""The access log: one line for each request and socket, without secrets."""

from __future__ import annotations

import logging
import re
from pathlib import Path

import pytest

from backend.settings import Settings
from tests.api.conftest import Fresh, running
from tests.given.service import until
from tests.given.submissions import submit
from tests.given.viewer_clients import KEY, viewing

LINE = re.compile(r"\d{4}-\d\d-\d\dT[\d:.]+\+00:00 (\S+) (\S+) (\S+) (\S+) (\d+|-) (\d+) (\d+\.\d{3})")


def lines(caplog: pytest.LogCaptureFixture) -> list[tuple[str, ...]]:
    """Address, user, method, path and status of each line."""
    found = []
    for record in list(caplog.records):
        if record.name == "clearance.access":
            line = LINE.fullmatch(record.getMessage())
            assert line, record.getMessage()
            found.append(line.groups()[:5])
    return found


def test_a_line_for_each_request(fresh_sqlite: Fresh, tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO, "clearance.access")
    with running(fresh_sqlite, tmp_path, access_log=True, trusted_proxies="127.0.0.1") as service:
        with service.visitor(authorization=f"Bearer {service.token('ci')}") as program:
            program.get("/api/v1/runs?q=secret")
            # A line is written after its response, so the line of the next request can overtake it.
            until(lambda: len(lines(caplog)) == 1)
            program.get("/api/v1/runs/R-0009", headers={"x-forwarded-for": "10.0.0.7"})
            until(lambda: len(lines(caplog)) == 2)
        with service.visitor(host="evil.example") as stranger:
            stranger.get("/x%0Ainjected/" + "y" * 300)
        until(lambda: len(lines(caplog)) == 3)
        first, second, third = lines(caplog)
    assert first == ("127.0.0.1", "local/ci", "GET", "/api/v1/runs", "200")
    assert second == ("10.0.0.7", "local/ci", "GET", "/api/v1/runs/R-0009", "404")
    assert third[:3] == ("127.0.0.1", "-", "GET")
    assert third[3].startswith("/x%0Ainjected/")
    assert len(third[3]) == 200
    assert third[4] == "421"


def test_the_key_of_a_view_is_not_in_it(fresh_sqlite: Fresh, tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO, "clearance.access")
    with running(fresh_sqlite, tmp_path, access_log=True) as service, service.signed_in() as client:
        service.publish()
        with viewing(service, client, f"/view/{submit(client)}/key/{KEY}/"):
            pass
        until(lambda: any(line[2] == "SOCKET" for line in lines(caplog)))
        socket = next(line for line in lines(caplog) if line[2] == "SOCKET")
        assert socket == ("127.0.0.1", "local", "SOCKET", "/view/R-0001/key/-/", "101")
    assert not any(KEY in record.getMessage() for record in caplog.records)


def test_it_is_a_setting() -> None:
    assert not Settings.load({}).access_log
    assert Settings.load({"CLEARANCE_ACCESS_LOG": "true"}).access_log
