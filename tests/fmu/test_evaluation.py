"""FMUs in slots: agreement with the closed form, reuse of instances, and a reason for everything that goes wrong."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from campaigns import Campaign
from campaigns.results.base import FAILED, OK, TIMEOUT
from clearance.local.failures import OUTPUT
from tests.faults.processes import REPOSITORY
from tests.fmu import made
from worker.engine.systems.base import CampaignUnusable
from worker.engine.systems.simulators.declared.descriptor import read
from worker.engine.systems.simulators.declared.fmu import DescribedFmu
from worker.engine.systems.simulators.declared.simulator import Opening
from worker.engine.systems.simulators.fmus.simulator import FmuSimulator, FmuUnusable, opened
from worker.engine.systems.simulators.fmus.taken import NotTaken, Taken
from worker.evidence.scopes.terms import terms
from worker.running.opening.opened import system


def simulator(folder: Path, result: str = "separation") -> FmuSimulator:
    described = read(folder)
    assert isinstance(described, DescribedFmu)
    return opened(described, Opening({f"simulator.{p.name}": p.default for p in described.entry.parameters}, result))


def values(folder: Path, *cases: Any, result: str) -> Any:
    simulated = simulator(folder, result)
    try:
        batch, reasons = simulated.evaluate(np.array(cases, dtype=float))
    finally:
        simulated.close()
    assert reasons == {}
    return batch.costs[:, 0]


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> dict[int, Path]:
    return {fmi: made.folder(tmp_path_factory.mktemp(f"fmi{fmi}"), fmi) for fmi in (2, 3)}


@pytest.fixture(scope="module", params=[2, pytest.param(3, marks=pytest.mark.nightly)])
def simulated(request: pytest.FixtureRequest, folders: dict[int, Path]) -> Iterator[FmuSimulator]:
    found = simulator(folders[request.param])
    yield found
    found.close()


def flown(mass: float, speed: float, angle: float, time: float) -> tuple[float, float]:
    """Position after a throw with linear drag F = -0.5 v, in closed form [m]."""
    k = 0.5 / mass
    decay = -math.expm1(-k * time) / k
    return speed * math.cos(angle) * decay, (speed * math.sin(angle) + 9.81 / k) * decay - 9.81 * time / k


@pytest.mark.by_day(1)
@pytest.mark.parametrize("fmi", [2, 3])
def test_it_agrees_with_the_closed_form_to_the_order_of_its_step(tmp_path: Path, fmi: int) -> None:
    case = (2.0, 15.0, 1.0, 0.0)
    exact = flown(*case[:3], 3.0)[0]
    errors = []
    for step in (0.02, 0.01):
        folder = made.folder(tmp_path / str(step), fmi, described={"step": step})
        errors.append(abs(values(folder, case, result="far")[0] - exact))
    assert errors[1] < 1e-4
    assert 3.5 < errors[0] / errors[1] < 4.5, "Heun's method is of second order"


def test_a_result_takes_what_its_descriptor_states(folders: dict[int, Path]) -> None:
    case = (2.0, 15.0, 1.0, 0.0)
    path = np.array([flown(*case[:3], 0.01 * k) for k in range(301)])
    dx, dz = path[:, 0] - 12.0, np.maximum(path[:, 1] - 8.0, 0.0)
    assert values(folders[2], case, result="separation")[0] == pytest.approx(np.hypot(dx, dz).min(), abs=1e-3)
    assert values(folders[3], case, result="height")[0] == pytest.approx(path[:, 1].max(), abs=1e-3)
    landing = values(folders[2], case, result="landing")[0]
    assert abs(flown(*case[:3], landing)[1]) < 1e-2


def test_a_crossing_that_never_happens_is_a_failure_with_a_sentence(folders: dict[int, Path]) -> None:
    simulated = simulator(folders[2], "landing")
    batch, reasons = simulated.evaluate(np.array([[2.0, 40.0, 1.5, 0.0]]))
    simulated.close()
    assert batch.status.tolist() == [FAILED]
    assert reasons[0].startswith("the variable z does not cross 0 while falling until t = 3 s; it stays within [0, ")


def test_set_gives_values_to_further_variables(tmp_path: Path) -> None:
    folder = made.folder(tmp_path, 3, described={"set": {"drag": False}})
    assert values(folder, (2.0, 15.0, 1.0, 0.0), result="far")[0] == pytest.approx(15.0 * math.cos(1.0) * 3.0)


TROUBLE = [
    (0, OK, ""),
    (1, FAILED, "DoStep returned error at t = 0.49 s; its last output: [error] lost the mass"),
    (2, FAILED, "DoStep returned discard at t = 0.49 s"),
    (3, FAILED, "its process was killed by SIGSEGV"),
    (4, FAILED, "the model ended the simulation at t = 0.5 s, before 3 s"),
    (5, FAILED, "the variable separation is nan at t = 0.5 s"),
    (6, TIMEOUT, "no answer within 2 s"),
    (7, FAILED, "DoStep returned fatal at t = 0.49 s; its last output: [fatal] ruined everything"),
    (8, FAILED, "its process ended with exit code 3"),
    (9, OK, ""),
]


@pytest.mark.nightly
def test_whatever_goes_wrong_costs_one_evaluation(simulated: FmuSimulator) -> None:
    good, light = [2.0, 15.0, 1.0, 0.0], [0.6, 15.0, 1.0, 0.0]
    rows = [row for number, _, _ in TROUBLE for row in ([2.0, 15.0, 1.0, float(number)], good)]
    batch, reasons = simulated.evaluate(np.array([*rows, light, good]))
    for k, (_, status, reason) in enumerate(TROUBLE):
        assert batch.status[2 * k] == status, reasons
        assert reason in reasons.get(2 * k, "")
    assert "EnterInitializationMode " in reasons[len(rows)]
    assert f"{OUTPUT}[error] cannot throw" in reasons[len(rows)]
    assert batch.status[1::2].tolist() == [OK] * (len(TROUBLE) + 1)
    assert np.unique(batch.costs[1::2, 0]).size == 1, "what failed changed another evaluation"


@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    ("leak", "how"),
    [
        (0, "one instance for all"),
        (1, "a new instance for each"),
        (2, "a new process for each"),
        pytest.param(3, "a new instance for each", marks=pytest.mark.nightly),
    ],
)
@pytest.mark.parametrize("fmi", [2, pytest.param(3, marks=pytest.mark.nightly)])
def test_state_that_stays_behind_is_noticed_and_changes_nothing(tmp_path: Path, fmi: int, leak: int, how: str) -> None:
    """Whatever leaks, the nominal case repeats to the bit and equals that of the model that leaks nothing."""
    simulated = simulator(made.folder(tmp_path / "a", fmi, leak), "far")
    batch, reasons = simulated.evaluate(np.array([[2, 15, 1, 0], [2, 30, 1, 0], [2, 15, 1, 0]], dtype=float))
    (confirmed,) = simulated.confirm(simulated.nominal[None, :], [None])
    text = "".join(span.text for span in terms(simulated).scope.settings)  # type: ignore[union-attr]
    simulated.close()
    assert how in text
    assert reasons == {}
    assert batch.costs[0, 0] == batch.costs[2, 0] == confirmed.cost == confirmed.comparisons[-1].cost
    assert batch.costs[0, 0] != batch.costs[1, 0]


@pytest.mark.parametrize(
    ("fmi", "what"),
    [pytest.param(2, "GUID", marks=pytest.mark.nightly), (3, "instantiation token")],  # by day a campaign on one, below
)
def test_a_wrong_token_is_refused_before_anything_is_evaluated(tmp_path: Path, fmi: int, what: str) -> None:
    with pytest.raises(FmuUnusable, match=f"refuses to be instantiated; .*{what} is .8c4e810f"):
        simulator(made.folder(tmp_path, fmi, token="{other}"))


def test_a_binary_that_cannot_be_loaded_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FmuUnusable, match=r"the FMU cannot be loaded: .*thrown\.so"):
        simulator(made.folder(tmp_path, 2, binary=b"not a library"))


@pytest.mark.nightly
def test_a_file_that_changes_meanwhile_is_not_simulated(tmp_path: Path) -> None:
    simulated = simulator(made.folder(tmp_path, 2))
    made.fmu(tmp_path / "model.fmu", 2, leak=1)
    batch, reasons = simulated.evaluate(simulated.nominal[None, :])
    simulated.close()
    assert batch.status.tolist() == [FAILED]
    assert "model.fmu has changed since this run opened it" in reasons[0]


def test_what_was_extracted_is_removed_at_the_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    work = tmp_path / "work"
    work.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(work))
    simulated = simulator(made.folder(tmp_path / "a", 2))
    simulated.evaluate(simulated.nominal[None, :])
    assert len(list(work.rglob("thrown.so"))) == 1
    simulated.close()
    assert list(work.iterdir()) == []


@pytest.mark.parametrize(("direction", "expected"), [("rising", 0.5), ("falling", 1.5), ("either", 0.5), (None, 0.5)])
def test_a_crossing_is_interpolated_between_two_samples(direction: str | None, expected: float) -> None:
    taken = Taken({"variable": "v", "take": "first_crossing", "level": 1.0, "direction": direction})
    for time, value in enumerate((0.0, 2.0, 0.0, 2.0)):
        taken.see(float(time), value)
    assert taken.value() == expected


def test_a_start_on_the_level_is_not_a_crossing() -> None:
    taken = Taken({"variable": "v", "take": "first_crossing", "level": 0.0, "direction": "falling"})
    taken.see(0.0, 0.0)
    taken.see(1.0, -1.0)
    with pytest.raises(NotTaken, match=" t = 1 s"):
        taken.value()


def example(tmp_path: Path, **stages: Any) -> tuple[int, Any, str]:
    """The example from its sources to a verdict; stages: those that differ."""
    made.example(tmp_path)
    campaign = yaml.safe_load((made.EXAMPLE.parent / "campaigns" / "fmu_drop.yaml").read_text())
    campaign["stages"] |= stages
    (tmp_path / "campaign.yaml").write_text(yaml.safe_dump(campaign))
    done = subprocess.run(
        [sys.executable, "-m", "clearance", "run", str(tmp_path / "campaign.yaml"), "--json"],
        env=os.environ | {"CLEARANCE_SIMULATORS": str(tmp_path)}, capture_output=True, text=True, check=False,
        cwd=REPOSITORY, timeout=280,
    )  # fmt: skip
    return done.returncode, json.loads(done.stdout) if done.stdout.startswith("{") else None, done.stderr


SCOPE = "FMI 2.0 co-simulation from 0 s to 8 s, communication step 0.01 s, one instance for all evaluations"


@pytest.mark.nightly
def test_the_example_from_its_sources_to_a_verdict(tmp_path: Path) -> None:
    """Hundreds of evaluations are repeated, each in a new process: a minute of processor time."""
    code, result, errors = example(tmp_path)
    assert code == 1, errors
    assert result["verdict"] == "violated"
    assert SCOPE in json.dumps(result)
    repeated = result["findings"][0]["validation"]
    assert repeated["again"]["cost"] == repeated["cost"]


CAMPAIGN = {
    "name": "Thrown",
    "simulator": {"name": "thrown"},
    "uncertain": {"simulator.mass": {"low": 1.0, "high": 4.0}},
    "criterion": {"result": "separation", "threshold": 1.0},
    "stages": {"search": [{"method": "direct", "evaluations": 100}]},
}


def test_a_campaign_opens_it(installed: Path) -> None:
    made.folder(installed / "one", 3)
    found = system(Campaign.model_validate(CAMPAIGN))
    batch, reasons = found.evaluate(found.nominal[None, :])
    found.close()
    assert reasons == {}
    assert batch.costs[0, 0] == pytest.approx(0.0042, abs=1e-3)
    assert found.settings.step == 0.01
    assert " 0.01 s, " in terms(found).caveat


def test_a_campaign_on_an_fmu_that_refuses_is_refused(installed: Path) -> None:
    made.folder(installed / "one", 2, token="{other}")
    with pytest.raises(CampaignUnusable, match=r"GUID is .8c4e810f"):
        system(Campaign.model_validate(CAMPAIGN))
