"""The sentence on a sample that was evaluated again names what could not be drawn, and what differs."""

from __future__ import annotations

from typing import Any, cast

import pytest

from backend.scenes.base.setting import Setting
from backend.scenes.panel.sample import Tally
from campaigns.identity.identity import Identity


class _Of:
    """What is needed of a setting."""

    identity = Identity(engine="a", files={"simulators/wind": "d"})
    clears = False
    other_code = Setting.other_code


def answer(cost: float | None = 1.0, digest: str = "d", reason: str = "", untraced: str = "") -> dict[str, Any]:
    code = {"engine": "a", "files": {"simulators/wind": digest}}
    return {"status": "ok", "cost": cost, "identity": code, "reason": reason, "untraced": untraced}


@pytest.mark.parametrize(
    ("size", "answers", "expected"),
    [
        (1, [(answer(), 1.0, True)], "by one call. All results equal the stored ones."),
        (5, [(answer(), 1.0, True)], "the first 1 of the sample of certify, as many as were evaluated within 60 s,"),
        (1, [(answer(2.0), 1.0, True)], "1 result differs from the stored one."),
        (1, [(answer(None, reason="it crashed."), None, False)], "1 of them cannot be drawn: it crashed. All"),
        (1, [(answer(None, reason="it crashed"), 1.0, False)], "it crashed. 1 result differs"),
        (1, [(answer(untraced="its trace lacks x"), 1.0, False)], "cannot be drawn: its trace lacks x."),
        (1, [(answer(), 1.0, False)], "cannot be drawn: its trace has no positions."),
        (1, [(answer(digest="e"), 1.0, True)], "Simulated by other code than that of the run: simulators/wind."),
    ],
)
def test_the_sentence_counts_differences_and_failures(
    size: int, answers: list[tuple[dict[str, Any], float | None, bool]], expected: str
) -> None:
    told = Tally("certify", size, cast(Setting, _Of()))
    for given in answers:
        told.count(*given)
    assert expected in told.words()
