"""Live simulations: the protocol of `python -m worker.running.processes.live`, with a real process."""

from __future__ import annotations

import json
import sys
from typing import Any

import pytest

from campaigns import library, load_file
from campaigns.asked.scenario import MAX_REALISATION
from campaigns.results.draws import of_draws
from clearance.testing.problems import Problem
from tests.given.case_campaigns import CASE1, document
from tests.given.live_process import Live
from worker.running.processes import memory


def test_a_flight_is_simulated_on_request(live: Live) -> None:
    answer = live.ask(id=7, campaign=CASE1, parameters={"vehicle.m": 6.0, "vehicle.J": 0.06}, rows=100)
    assert set(answer) == {"id", "status", "reason", "cost", "margin", "columns", "data", "meta", "identity"}
    assert (answer["id"], answer["status"], answer["reason"]) == (7, "ok", "")
    assert answer["cost"] == pytest.approx(0.9417402, abs=2e-6)
    assert answer["margin"] == answer["cost"] - 0.5
    assert list(answer["data"]) == [c["name"] for c in answer["columns"]]
    assert {len(values) for values in answer["data"].values()} == {len(answer["data"]["t"])}
    assert 50 < len(answer["data"]["t"]) <= 100
    assert answer["meta"]["closest"]["value"] == pytest.approx(answer["cost"], abs=1e-9)


def test_what_is_left_out_is_nominal(live: Live) -> None:
    answer = live.ask(id="a", campaign=CASE1)
    assert answer["id"] == "a"
    assert answer["cost"] == pytest.approx(0.9435642, abs=2e-6)
    assert 300 < len(answer["data"]["t"]) <= 400
    assert answer["meta"]["parameters"] == {"vehicle.m": 5.0, "vehicle.J": 0.05}


def test_what_is_certain_may_be_moved_too(live: Live) -> None:
    moved = live.ask(id=1, campaign=CASE1, parameters={"obstacles.0.position.x": 40.0, "start.v": 0.5})
    assert moved["status"] == "ok"
    assert moved["meta"]["obstacles"][0]["position"] == [40.0, 4.0, 0.0]
    assert moved["data"]["v"][0] == 0.5


def test_answers_come_in_order_with_their_ids(live: Live) -> None:
    for number in range(5):
        live.say(json.dumps({"id": number, "campaign": CASE1, "rows": 2}).encode())
    assert [live.hear()["id"] for _ in range(5)] == list(range(5))


def test_a_failed_flight_has_a_reason(live: Live) -> None:
    answer = live.ask(id=1, campaign=CASE1, parameters={"vehicle.J": 0.001})
    assert (answer["status"], answer["cost"], answer["margin"]) == ("failed", None, None)
    assert " t = 0.005 s" in answer["reason"]
    assert answer["data"]["t"] == [0.0, 0.005]


def test_an_excluded_flight_has_a_reason(live: Live) -> None:
    answer = live.ask(id=1, campaign=CASE1, parameters={"start.x": 4.0, "start.y": 4.0})
    assert (answer["status"], answer["cost"]) == ("excluded", None)
    assert " 0.5 m" in answer["reason"]


@pytest.mark.parametrize(
    ("parameters", "statement"),
    [
        ({"vehicle.n": 1.0}, "the scenario has no parameter 'vehicle.n'"),
        ({"vehicle.m": 0.0}, "vehicle.m must be within 0.001 to 100000 kg, given 0.0"),
        ({"vehicle.m": float("nan")}, "vehicle.m must be within 0.001 to 100000 kg, given nan"),
        ({"vehicle.m": float("inf")}, "vehicle.m must be within 0.001 to 100000 kg, given inf"),
        ({"vehicle.m": "5"}, "vehicle.m must be a number, given '5'"),
        ({"vehicle.m": True}, "vehicle.m must be a number, given True"),
        ({"vehicle.m": None}, "vehicle.m must be a number, given None"),
        ([5.0], "invalid request"),
    ],
)
def test_parameters_that_cannot_be_simulated(live: Live, parameters: Any, statement: str) -> None:
    answer = live.ask(id=3, campaign=CASE1, parameters=parameters)
    assert set(answer) == {"id", "error"}
    assert answer["id"] == 3
    assert statement in answer["error"]


@pytest.mark.parametrize(
    ("request_", "statement"),
    [
        (b"{", "invalid request: JSONDecodeError"),
        (b"[]", "invalid request: TypeError"),
        (b"null", "invalid request: TypeError"),
        (b"{}", "invalid request: KeyError: 'id'"),
        (b'{"id": "\xff"}', "invalid request: UnicodeDecodeError"),
        (b'{"id": NaN, "campaign": {}}', "invalid request: TypeError: id must be a whole number or text"),
        (b'{"id": [1], "campaign": {}}', "invalid request: TypeError: id must be a whole number or text"),
        (b'{"id": 1}', "invalid request: KeyError: 'campaign'"),
        (b"[" * 100_000, "nested too deeply"),
        (b'{"id": 1, "campaign": [], "rows": 5}', "a campaign is a mapping"),
        (b'{"id": 1, "campaign": {}}', "scenario: this key is required"),
    ],
)
def test_invalid_requests_are_refused(live: Live, request_: bytes, statement: str) -> None:
    live.say(request_)
    answer = live.hear()
    assert set(answer) == {"id", "error"}
    assert statement in answer["error"] or "RecursionError" in answer["error"]


@pytest.mark.parametrize("rows", ["many", [1], -5, 0, 10**9, None])
def test_odd_numbers_of_rows_do_no_harm(live: Live, rows: Any) -> None:
    answer = live.ask(id=1, campaign=CASE1, rows=rows)
    assert "error" in answer or len(answer["data"]["t"]) <= 3001


def test_a_campaign_that_this_installation_cannot_simulate(live: Live) -> None:
    answer = live.ask(id=1, campaign=document(scenario__vehicle__component="car"))
    assert "scenario.vehicle.component: no such vehicle; " in answer["error"]


def test_many_campaigns_in_turn(live: Live) -> None:
    # More than it caches; then the first again.
    thresholds = [0.4 + k / 100 for k in range(18)] + [0.4]
    margins = [
        live.ask(id=k, campaign=document(criterion__threshold=t), rows=2)["margin"] for k, t in enumerate(thresholds)
    ]
    assert margins == pytest.approx([0.943564 - t for t in thresholds], abs=1e-5)


@pytest.mark.nightly
@pytest.mark.skipif(sys.platform != "linux", reason="address space is bounded on Linux alone")
def test_a_simulation_beyond_its_memory_limit_is_an_error_and_the_next_one_runs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """And the process ends with its input, even in the middle of a line."""
    small = Live(CLEARANCE_CHILD_MEMORY="0.25", CLEARANCE_THREADS="1")
    assert small.hear() == {"ready": True}
    long = document(scenario__horizon=2000, scenario__step=0.001)
    answer = small.ask(id=1, campaign=long, parameters={})
    monkeypatch.setenv("CLEARANCE_CHILD_MEMORY", "0.25")
    assert answer["error"] == memory.sentence()
    assert small.ask(id=2, campaign=CASE1, parameters={})["status"] == "ok"
    assert small.process.stdin is not None
    small.process.stdin.write(b'{"id": 3')
    assert small.end() == (0, b"")


@pytest.mark.nightly  # by day tests/unit/clearance/cli/test_cli_run.py: the command line refuses it in the same words
def test_a_memory_bound_that_is_no_number_ends_the_process_with_a_sentence() -> None:
    wrong = Live(CLEARANCE_CHILD_MEMORY="lots")
    status, errors = wrong.end()
    assert status == 1
    assert errors.startswith(b"invalid CLEARANCE_CHILD_MEMORY 'lots': ")


def test_a_flight_has_its_own_noise(live: Live) -> None:
    """A seed replaces the realisations of the campaign."""
    campaign = load_file(library()["unicycle_noise"])
    noisy, problem = campaign.document(), Problem(campaign)
    drawn = int(of_draws(problem.campaign.seed, 3, 1)[0])
    stated = live.ask(id=1, campaign=noisy)
    by_seed = live.ask(id=2, campaign=noisy, seed=drawn)
    own, _ = problem.under(drawn).evaluate(problem.nominal_point[None, :])
    assert by_seed["cost"] == own.costs[0, 0] != stated["cost"]
    assert by_seed["meta"]["realisation"]["seed"] == drawn
    assert stated["meta"]["realisation"]["seeds"] == len(campaign.scenario.realisations.seeds)


@pytest.mark.parametrize("given", [-1, 2**40, 1.5, True, "3"])
def test_noise_that_does_not_exist_is_refused(live: Live, given: Any) -> None:
    error = live.ask(id=1, campaign=CASE1, seed=given)["error"]
    assert error.endswith(f" from 0 to {MAX_REALISATION - 1}, given {given!r}")
