"""`clearance check-simulator` on the simulators that an installation may have."""

from __future__ import annotations

import pytest

from campaigns.results.base import FAILED, OK
from tests.simulators.adversaries import Call, adversary, never
from worker.cli import WRONG_INPUT, invoke
from worker.cli.check_simulator import NOT_AS_IT_IS


def test_one_that_can_be_used_as_it_is(capsys: pytest.CaptureFixture[str]) -> None:
    with adversary():
        assert invoke(["check-simulator", "adversary", "--points", "7"]) == 0
    shown = capsys.readouterr().out
    assert "parameter a: nominal 0.5, 0 to 1" in shown
    assert "result d [m], worse when low" in shown
    assert "21 of 21 evaluations of 7 points have a value of d" in shown
    assert "repeats bit by bit: 7 points, 21 evaluations" in shown
    assert "Proposal" not in shown
    (asked,) = [line for line in shown.splitlines() if line.startswith("methods and budgets for it: clearance ")]
    assert invoke(asked.partition("clearance ")[2].split()) == 0


@pytest.mark.parametrize("how", ["noise", "tiny noise", "drift", "noise of the process", "by call count"])
def test_one_that_does_not_repeat(how: str, capsys: pytest.CaptureFixture[str]) -> None:
    with adversary(how):
        assert invoke(["check-simulator", "adversary"]) == NOT_AS_IT_IS
    shown = capsys.readouterr().out
    assert "differs by up to" in shown
    assert "repeats: {count: 5, combine: worst}" in shown
    assert ("set recycle: 1" in shown) == (how == "noise of the process")


def test_one_that_declares_noise_but_shows_none(capsys: pytest.CaptureFixture[str]) -> None:
    with adversary(declared=False):
        assert invoke(["check-simulator", "adversary"]) == NOT_AS_IT_IS
    assert "the simulator declares that its results do not repeat" in capsys.readouterr().out


def test_one_that_fails_at_some_points(capsys: pytest.CaptureFixture[str]) -> None:
    def beyond(call: Call) -> int:
        return FAILED if call.a > 0.7 else OK

    with adversary("none", beyond):
        assert invoke(["check-simulator", "adversary", "--points", "9"]) == NOT_AS_IT_IS
    shown = capsys.readouterr().out
    assert "failed: its process ended with exit code 3" in shown
    assert "repeats bit by bit" in shown


def test_one_that_always_fails(capsys: pytest.CaptureFixture[str]) -> None:
    with adversary("none", never):
        assert invoke(["check-simulator", "adversary"]) == NOT_AS_IT_IS
    shown = capsys.readouterr().out
    assert "0 of 15 evaluations of 5 points have a value of d" in shown
    assert "whether it repeats is unknown" in shown
    assert "Proposal" not in shown


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (["adversari"], "did you mean 'adversary'?"),
        (["x"], "choose one of: "),
        (["adversary", "--result", "e"], "has no such result"),
        (["adversary", "--points", "1"], "--points"),
    ],
)
def test_what_does_not_fit_is_refused(given: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    with adversary():
        assert invoke(["check-simulator", *given]) == WRONG_INPUT
    assert said in capsys.readouterr().err
