"""The command line in the process of the test, as a client of its service."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from clearance.cli import invoke
from tests.given.service import Service


@pytest.fixture
def command(service: Service, monkeypatch: pytest.MonkeyPatch) -> Callable[..., int]:
    """The command line, with the service's address and a token in its environment."""
    monkeypatch.setenv("CLEARANCE_SERVICE", service.url)
    monkeypatch.setenv("CLEARANCE_TOKEN", service.token())
    monkeypatch.delenv("GITHUB_STEP_SUMMARY", raising=False)
    return lambda *arguments: invoke([*map(str, arguments)])
