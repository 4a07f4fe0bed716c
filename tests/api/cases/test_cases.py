"""What-if of a simulator through the service: evaluated in a child process, drawn in the view, never stored."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from backend.cases.service import process
from backend.scenes.live.live import Live
from campaigns.stored.records import Columns, StagePlan
from tests.faults.processes import until
from tests.given.declared_traces import SCENE, declared
from tests.given.finished_runs import PLAN
from tests.given.openapi_document import conforms
from tests.given.problem_documents import problem
from tests.given.service import Service
from tests.given.submissions import submit
from tests.given.viewer_clients import KEY, frames_until, steer, viewing
from worker.engine.systems.simulators.slots.guard import PLACE

STAND_IN = """
import json, sys, time
print(json.dumps({"ready": True}), flush=True)
for line in sys.stdin:
    asked = json.loads(line)
    if asked.get("kind") == "installed": print(json.dumps({"id": asked["id"], "missing": ""}), flush=True); continue
    wind = asked["parameters"].get("simulator.wind", 1.0)
    if wind == 4.0: time.sleep(60)
    if wind == 3.0: print(json.dumps({"id": asked["id"], "error": "there is no such simulator"}), flush=True); continue
    columns = [{"name": "time", "symbol": "t", "unit": "s", "group": "time"}]
    columns += [{"name": n, "symbol": n, "unit": "m", "group": "signal"} for n in ("x", "z", "bird")]
    data = {"time": [0.0, 1.0], "x": [0.0, wind], "z": [9.0, 8.0], "bird": [0.0, 0.0]}
    meta = {"parameters": asked["parameters"], "status": "ok", "cost": wind, "values": {"separation": wind}}
    meta["scene"] = SCENE
    if wind < 0: columns, data = [], {}
    told = {"status": "ok", "reason": ""} if wind >= 0 else {"status": "failed", "reason": "it crashed"}
    told |= {"cost": wind, "margin": wind - 1.0, "columns": columns, "data": data}
    told |= {"meta": meta, "seconds": 0.25, "untraced": "", "needs": asked["simulator"]}
    told |= {"identity": {"engine": "0" * 64}}
    print(json.dumps({"id": asked["id"], **told}), flush=True)
"""


@pytest.fixture
def evaluating(bare: Service) -> Iterator[Service]:
    """A service whose evaluating process is a stand-in."""
    bare.app.state.cases.close()
    bare.app.state.cases = Live((sys.executable, "-c", STAND_IN.replace("SCENE", repr(SCENE))), 2.0, 10.0)
    yield bare
    bare.app.state.cases.close()


def asked(client: httpx.Client, run: str, **given: Any) -> httpx.Response:
    return client.post(f"/api/v1/runs/{run}/cases", json=given, timeout=60)


def test_a_case_is_evaluated_drawn_and_not_stored(evaluating: Service) -> None:
    with evaluating.signed_in() as client:
        run = declared(evaluating, client)
        before = evaluating.rows()
        with viewing(evaluating, client, f"/view/{run}/key/{KEY}") as connection:
            frames_until(connection, b"Search")
            answer = asked(client, run, parameters={"simulator.wind": 2.0}, view=KEY, rows=10)
            assert answer.status_code == 200, answer.text
            frames_until(connection, b"/flights/what-if/path")
            assert steer(client, run)["what_if"] == {"simulator.wind": 2.0}
            lost = asked(client, run, parameters={"simulator.wind": -1.0}, view=KEY, rows=10).json()
            assert (lost["status"], lost["reason"], lost["data"]) == ("failed", "it crashed", {})
            assert steer(client, run)["what_if"] is None, "the view does not keep showing another case"
        found = answer.json()
        conforms(found, {"$ref": "#/components/schemas/CaseAnswer"})
        assert (found["cost"], found["margin"], found["threshold"], found["unit"]) == (2.0, 1.0, 1.0, "m")
        assert (found["seconds"], found["code_known"], found["drawn"], found["seed"]) == (0.25, False, KEY, None)
        assert found["criteria"][0]["value"] == 2.0
        assert found["data"]["x"] == [0.0, 2.0]
        assert asked(client, run).json()["data"] == {}
        assert evaluating.rows() == before


RANDOM = [*PLAN[:2], StagePlan("search", "monte_carlo", 3)]


def sample(*cost: float) -> Columns:
    """A random sample at a wind of 0.5, 1 and 2 m/s, with these costs."""
    points = np.array([[0.125], [0.25], [0.5]])[: len(cost)]
    return Columns(points, np.array(cost)[:, None], np.zeros(len(cost), np.uint8), np.ones(len(cost)), {})


def test_the_sample_is_evaluated_again_drawn_and_compared_with_what_is_stored(evaluating: Service) -> None:
    with evaluating.signed_in() as client:
        run = declared(evaluating, client, searched=sample(0.5, 1.0, 7.0), plan=RANDOM)
        before = evaluating.rows()
        with viewing(evaluating, client, f"/view/{run}/key/{KEY}") as connection:
            frames_until(connection, b"Search")
            assert steer(client, run, layers={"sampled": True})["layers"]["sampled"] is True
            statement = b"the first 3 of the sample of MONTE_CARLO, each evaluated again by one call."
            frames_until(connection, b"/flights/sampled/2", statement, b"1 result differs from the stored one.")
            assert steer(client, run, layers={"sampled": False})["layers"]["sampled"] is False
        assert evaluating.rows() == before, "nothing of it is stored"


def test_a_sample_that_cannot_be_evaluated_here_is_no_line_but_a_sentence(evaluating: Service) -> None:
    with evaluating.signed_in() as client:
        points = Columns(np.array([[0.75]]), np.array([[3.0]]), np.zeros(1, np.uint8), np.ones(1), {})
        run = declared(evaluating, client, searched=points, plan=RANDOM)
        with viewing(evaluating, client, f"/view/{run}/key/{KEY}") as connection:
            frames_until(connection, b"Search")
            steer(client, run, layers={"sampled": True})
            assert b"/flights/sampled/0" not in frames_until(connection, b"there is no such simulator")


def test_what_cannot_be_evaluated_is_refused_in_words(evaluating: Service) -> None:
    with evaluating.signed_in() as client:
        run = declared(evaluating, client)
        for given, status, kind, words in (
            ({"parameters": {"simulator.wind": 9.0}}, 422, "outside-limits", "-5 to 5 m/s"),
            ({"parameters": {"simulator.mass": 1.0}}, 422, "unknown-parameter", "the simulator has no parameter"),
            ({"like": "F9"}, 422, "unknown-finding", "choose one of nominal, F1"),
            ({"seed": 3}, 422, "invalid-request", "seed"),
            ({"parameters": {"simulator.wind": 3.0}}, 422, "not-flyable", "there is no such simulator"),
        ):
            found = problem(asked(client, run, **given), status)
            assert found["type"].endswith(kind), found
            assert words in found["detail"]
        assert asked(client, run, parameters={"simulator.wind": 2.0}).status_code == 200
        late = problem(asked(client, run, parameters={"simulator.wind": 4.0}), 503)
        assert late["type"].endswith("case-failed")
        assert "The service waits 60 s" in late["detail"]
        assert asked(client, run, parameters={"simulator.wind": 2.0}).status_code == 200, "a new process"
        with evaluating.visitor() as other:
            assert asked(other, run).status_code == 401


def test_a_scenario_has_flights_and_no_cases(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    for found in (asked(client, run), client.get(f"/api/v1/runs/{run}/cases")):
        assert f"POST /runs/{run}/flights" in problem(found, 422)["detail"]
    problem(client.get("/api/v1/runs/R-0099/cases"), 404)


def test_whether_it_is_installed_evaluates_nothing(evaluating: Service) -> None:
    with evaluating.signed_in() as client:
        run = declared(evaluating, client)
        before = evaluating.rows()
        found = client.get(f"/api/v1/runs/{run}/cases").json()
        conforms(found, {"$ref": "#/components/schemas/CaseInstalled"})
        assert evaluating.rows() == before
        evaluating.app.state.cases.close()
        assert problem(client.get(f"/api/v1/runs/{run}/cases"), 503)["type"].endswith("case-failed")


PROGRAM = f"""
import clearance

@clearance.simulator(
    name="drop", title="Parachute drop",
    parameters={{"wind": clearance.Parameter(-5.0, 5.0, nominal=1.0, unit="m/s", text="Wind", symbol="w")}},
    results={{"separation": clearance.Output(unit="m", title="Separation", quantity="d_min")}},
    trace={{"time": {{}}, "x": {{"unit": "m"}}, "z": {{"unit": "m"}}, "bird": {{"unit": "m"}}}}, scene={SCENE!r},
)
def drop(wind, trace=False):
    \"\"\"A load falls.\"\"\"
    columns = {{"time": [0, 1], "x": [0, wind], "z": [9, 8], "bird": [0, 0]}}
    return (wind, columns) if trace else wind
"""


# By day the process without a service, tests/unit/running/processes/test_cases.py, and a service with a stand-in.
@pytest.mark.nightly
def test_the_real_process_evaluates_the_operators_code(
    bare: Service, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "operated").mkdir()
    (tmp_path / "operated" / "drop.py").write_text(PROGRAM, encoding="utf-8")
    monkeypatch.setenv("CLEARANCE_SIMULATORS", str(tmp_path / "operated"))
    program = tmp_path / "operated" / "drop.py"
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    monkeypatch.setenv("TMPDIR", str(temporary))
    bare.app.state.cases._grace = 60.0  # whatever else this machine does meanwhile
    with bare.signed_in() as client:
        run = declared(bare, client)
        missing = program.rename(tmp_path / "drop.py")
        there = client.get(f"/api/v1/runs/{run}/cases", timeout=60).json()
        assert there["installed"] is False
        assert "CLEARANCE_SIMULATORS" in there["reason"]
        missing.rename(program)
        again = client.get(f"/api/v1/runs/{run}/cases", timeout=60)
        assert again.json() == {"installed": True, "reason": ""}
        answer = asked(client, run, parameters={"simulator.wind": 2.5}, rows=10)
        assert answer.status_code == 200, answer.text
        found = answer.json()
        assert (found["cost"], found["status"], found["untraced"]) == (2.5, "ok", "")
        assert found["data"]["x"] == [0.0, 2.5]
        assert found["trace"]["scene"]["frame"] == "z_up"
        assert 0.0 < found["seconds"] < 5.0
        program.write_text(PROGRAM.replace("else wind", "else wind + 1").replace("(wind, col", "(wind + 1, col"))
        edited = partial(asked, client, run, parameters={"simulator.wind": 2.5})
        until(lambda: edited().json()["cost"] == 3.5, "the edited program is evaluated", 60)
    child = bare.app.state.cases._child._process
    (place,) = temporary.glob(f"{PLACE}cases-*")
    assert place.is_dir()
    bare.app.state.cases.close()
    assert child.returncode == 1, "it ended by itself"
    assert not place.exists(), "nothing is left of the process"


def test_the_process_is_not_started_before_it_is_needed() -> None:
    live = process()
    assert live._child is None
    live.close()
