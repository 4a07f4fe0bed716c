"""The service answers while others flood it with connections; `tests.bench.doors` measures all kinds."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.bench.doors import MANY, asked, besieged
from tests.given.floods import STRANGERS, VIEWERS, Flood, flooded

SECONDS = 3.0
LONGEST = 5.0
"""The limit of an answer [s], far above that of an idle machine, because a nightly run shares its processors."""


@pytest.mark.nightly
@pytest.mark.parametrize("sources", [("127.0.0.1",), MANY], ids=["one address", "many addresses"])
@pytest.mark.parametrize("kind", STRANGERS)
def test_a_flood_without_login_delays_no_other_client(tmp_path: Path, kind: str, sources: tuple[str, ...]) -> None:
    with besieged(tmp_path) as service, flooded(Flood(service.port, kind, STRANGERS[kind], sources=sources)):
        for answers in asked(service.port, service.other, SECONDS)[2:]:
            assert answers.failed == []
            assert max(answers.seconds) < LONGEST


@pytest.mark.nightly
@pytest.mark.parametrize("kind", VIEWERS)
def test_one_viewer_with_many_tokens(tmp_path: Path, kind: str) -> None:
    with besieged(tmp_path) as service, flooded(Flood(service.port, kind, VIEWERS[kind], service.viewer)):
        for answers in asked(service.port, service.other, SECONDS)[2:]:
            assert answers.failed == []
            assert max(answers.seconds) < LONGEST
