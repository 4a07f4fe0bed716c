"""Addresses of evaluators, and what the command line refuses."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest

from campaigns.refusals import RefusalCode
from clearance.cli import WRONG_INPUT, invoke
from tests.given.refused_commands import refused
from worker.engine.systems.simulators.cluster.address import SETTING, BadEvaluator, Evaluator, chosen, evaluator


def test_an_address_is_that_of_a_scheduler_or_of_processes_here() -> None:
    assert evaluator("local:4") == Evaluator("local:4", processes=4, slots=4)
    assert evaluator("dask://node1:8786").scheduler == "tcp://node1:8786"
    assert evaluator("dask://node1:8786/").scheduler == "tcp://node1:8786"
    assert evaluator("dask+tls://[::1]:8786").scheduler == "tls://[::1]:8786"
    stated = evaluator("dask://10.0.0.1:1?slots=32&patience=3600")
    assert (stated.scheduler, stated.slots, stated.patience) == ("tcp://10.0.0.1:1", 32, 3600.0)


@pytest.mark.parametrize(
    "given",
    [
        "local", "local:", "local:0", "local:-1", "local:2.5", "local:٣", "local:99999", "4", "node1:8786", "dask:",
        "dask://", "dask://node1", "dask://:8786", "dask://node1:port", "dask://node1:99999", "dask://me@node1:8786",
        "dask://node1:8786/path", "dask://node1:8786#x", "dask://[::1:8786", "tcp://node1:8786", "http://node1:8786",
    ],
)  # fmt: skip
def test_any_other_address_is_refused_with_what_is_expected(given: str) -> None:
    with pytest.raises(BadEvaluator, match=r"give local:N for N processes .* or dask://HOST:PORT") as refused:
        evaluator(given)
    assert repr(given) in str(refused.value)


@pytest.mark.parametrize("option", ["slots=0", "slots=x", "patience=0", "patience=1e9", "patience=nan", "other=1"])
def test_an_unknown_option_is_refused(option: str) -> None:
    with pytest.raises(BadEvaluator, match=f"invalid {option}: allowed are slots=1 to"):
        evaluator(f"dask://node1:8786?{option}")


def test_without_the_extra_the_message_names_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(BadEvaluator, match=r"clearance\[cluster\]"):
        evaluator("local:2")


def test_nothing_is_chosen_unless_it_is_set(monkeypatch: pytest.MonkeyPatch) -> None:
    for given in ("", "  "):
        monkeypatch.setenv(SETTING, given)
        assert chosen() is None
    monkeypatch.setenv(SETTING, " local:2 ")
    assert chosen() == Evaluator("local:2", processes=2, slots=2)


def test_a_campaign_of_the_closed_loop_is_refused(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(SETTING, "")
    assert refused(capsys, "run", "unicycle_static", "--evaluator", "local:2") == RefusalCode.NOT_THERE


@pytest.mark.parametrize("command", [["run", "unicycle_static"], ["worker"]])
def test_a_wrong_address_is_refused_at_once(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], command: list[str], tmp_path: Path
) -> None:
    monkeypatch.setenv(SETTING, "")
    monkeypatch.chdir(tmp_path)
    assert invoke([*command, "--evaluator", "node1:8786"]) == WRONG_INPUT
    assert "invalid evaluator 'node1:8786': give local:N" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
    monkeypatch.setenv(SETTING, "node1:8786")
    assert invoke(command) == WRONG_INPUT
