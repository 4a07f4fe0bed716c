"""An FMU is read at communication points only: cases are confirmed at half the communication step, too."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.codes import CheckCode
from campaigns.results import Verdict
from campaigns.results.finding import Validation
from campaigns.results.remedies import Ran, remedies
from campaigns.results.verdict import Check
from campaigns.versions import Versions
from tests.audited import recorded
from tests.fmu import made
from tests.simulators.noisy import ran
from worker.engine.systems.base import Comparison, Confirmed
from worker.engine.systems.simulators.declared.descriptor import read
from worker.engine.systems.simulators.declared.fmu import STEP, DescribedFmu
from worker.engine.systems.simulators.declared.simulator import Opening
from worker.engine.systems.simulators.fmus.simulator import FmuSimulator, opened
from worker.evidence.audit import limits
from worker.evidence.audit.recompute import Run
from worker.evidence.scopes.simulators import simulator_caveat, words_of
from worker.running.runs.store import MemoryStore

LEFT: dict[str, Any] = {name: {} for name in made.VARIED if name != "trouble"}
STRAIGHT: dict[str, Any] = {"parameters": LEFT, "set": {"drag": False}}
"""Without drag the model's steps are exact, so that a value depends on the communication step by the readings alone."""
SHORT: dict[str, Any] = {"parameters": LEFT, "set": {"trouble": 10}, "step": 0.01}
"""It refuses communication steps below 0.01 s."""


def simulator(folder: Path, result: str) -> FmuSimulator:
    described = read(folder)
    assert isinstance(described, DescribedFmu)
    return opened(
        described, Opening({f"simulator.{p.name}": p.default or 0.0 for p in described.entry.parameters}, result)
    )


def confirmed(folder: Path, result: str) -> tuple[Confirmed, Comparison, Comparison]:
    """The nominal case, at half the step and again."""
    simulated = simulator(folder, result)
    try:
        (case,) = simulated.confirm(simulated.nominal[None, :], [None])
    finally:
        simulated.close()
    half, again = case.comparisons
    assert (half.kind, again.kind, case.step) == ("half_step", "again", simulated.step)
    assert half.step is not None
    assert 2 * half.step == simulated.step
    assert again.cost == case.cost
    return case, half, again


def thrown(time: float) -> dict[str, float]:
    """The nominal case without drag."""
    x, z = 15.0 * math.cos(1.0) * time, 15.0 * math.sin(1.0) * time - 0.5 * 9.81 * time**2
    return {"x": x, "z": z, "separation": math.hypot(x - 12.0, max(z - 8.0, 0.0))}


def taken(result: str, step: float) -> float:
    """What the result is of readings this far apart."""
    rows = [thrown(k * step) for k in range(round(3.0 / step) + 1)]
    if result == "landing":
        k = next(k for k, row in enumerate(rows) if k and row["z"] <= 0.0)
        before, after = rows[k - 1]["z"], rows[k]["z"]
        return float(step * (k - 1 + before / (before - after)))
    of = [row[made.RESULTS[result]["variable"]] for row in rows]
    return float({"separation": min(of), "height": max(of), "far": of[-1]}[result])


@pytest.mark.by_day(1)
@pytest.mark.parametrize("result", made.RESULTS)
@pytest.mark.parametrize("fmi", [2, pytest.param(3, marks=pytest.mark.nightly)])
def test_every_reading_is_made_again_at_half_the_communication_step(tmp_path: Path, fmi: int, result: str) -> None:
    """The load passes the mast between two points, is highest between two and lands between two."""
    case, half, _ = confirmed(made.folder(tmp_path, fmi, described=STRAIGHT | {"step": 1.0}), result)
    assert case.cost == pytest.approx(taken(result, 1.0), abs=1e-9)
    assert half.cost == pytest.approx(taken(result, 0.5), abs=1e-9)
    assert (abs(taken(result, 1.0) - taken(result, 0.5)) > 0.05) == (result != "far")


def test_the_catalogue_states_the_communication_step_as_its_step(tmp_path: Path) -> None:
    assert read(made.folder(tmp_path, 2)).entry.step == STEP


def test_half_the_step_has_twice_the_time(tmp_path: Path) -> None:
    simulated = simulator(made.folder(tmp_path, 2), "far")
    assert simulated.longest + 2.0 == simulated.halved().longest
    assert simulated.fresh().longest == simulated.longest
    assert simulated.halved().fresh().step == simulated.halved().step == 0.005
    simulated.close()


def test_a_model_that_refuses_half_the_step_says_so(tmp_path: Path) -> None:
    _, half, again = confirmed(made.folder(tmp_path, 2, described=SHORT), "far")
    assert half.cost is None
    assert half.reason.startswith("fmi2DoStep ")
    assert not again.reason


def campaign(threshold: float = 1.0, **simulator: Any) -> Campaign:
    """A short one, that takes validation no further than the cases and some random evaluations."""
    return load_document(
        {
            "name": "Thrown",
            "simulator": {"name": "thrown"} | simulator,
            "uncertain": {"simulator.speed": {"low": 14.5, "high": 15.5}},
            "criterion": {"result": "separation", "threshold": threshold},
            "stages": {
                "sensitivity": None,
                "search": [{"method": "direct", "evaluations": 30}],
                "findings": {"at_most": 1, "evaluations": 30},
                "validate": {"neighbours": 1, "evaluations": 40},
            },
        }
    )


class Judged(NamedTuple):
    """An audited run: its verdict, its check of repetition, and the validation of its worst case."""

    verdict: Verdict
    check: Check
    case: Validation
    store: MemoryStore


def judged(folder: Path, described: dict[str, Any], threshold: float = 1.0) -> Judged:
    made.folder(folder / "one", 2, described=described)
    verdict, store = ran(campaign(threshold))
    (check,) = (one for one in verdict.checks if one.code == CheckCode.REPETITION)
    case = store.findings[0].validation
    assert case is not None
    return Judged(verdict, check, case, store)


@pytest.mark.nightly
def test_a_load_that_passes_the_mast_between_two_points_is_not_confirmed(installed: Path) -> None:
    verdict, check, case, store = judged(installed, STRAIGHT | {"step": 1.0})
    assert case.half_step is not None
    assert case.half_step.cost is not None
    assert case.cost is not None
    assert case.half_step.cost < 1.0 < case.cost
    assert not case.ok
    assert check.text.startswith(words_of(True).disagrees)
    assert "nominal" in check.text
    assert verdict.verdict == "inconclusive"
    results = [stage.result for stage in store.stages]
    assert remedies(check.model_copy(update={"statement": ()}), Ran(campaign(), results)) == []


@pytest.mark.nightly
def test_readings_that_are_close_enough_are_confirmed(installed: Path) -> None:
    _, check, case, store = judged(installed, STRAIGHT | {"step": 0.001, "stop": 1.0})
    assert case.ok
    assert case.half_step is not None
    assert case.half_step.step == 0.0005
    assert check.text.startswith(words_of(True).agree)
    record = recorded(store, campaign())
    known = record.claims["components"]
    forgotten = [one.model_copy(update={"step": None}) for one in known.simulators]
    record.claims["components"] = known.model_copy(update={"simulators": forgotten})
    assert Run(record).means() == ("half_step", "again")
    versions = record.claims["versions"]
    record.claims["versions"] = Versions.of(versions).model_copy(update={"wording": limits.HALVED - 1}).model_dump()
    assert Run(record).means() == ("again",)
    assert Run(record, today=True).means() == ("half_step", "again")


@pytest.mark.nightly
def test_what_a_model_that_refuses_half_the_step_has_is_not_confirmed(installed: Path) -> None:
    _, check, case, _ = judged(installed, SHORT, threshold=0.0)
    assert not case.ok
    assert case.incomplete
    assert case.half_step is not None
    assert case.half_step.reason.startswith("fmi2DoStep ")
    assert case.half_step.reason in check.text


@pytest.mark.nightly
def test_several_calls_of_a_model_that_repeats_do_not_take_the_place_of_half_the_step(installed: Path) -> None:
    made.folder(installed / "one", 2, described=STRAIGHT | {"step": 1.0})
    verdict, _ = ran(campaign(repeats={"count": 2}))
    (check,) = (one for one in verdict.checks if one.code == CheckCode.CALLS)
    assert not check.ok
    assert check.text.endswith("simulator.repeats")


def test_the_caveat_says_whether_the_step_was_halved() -> None:
    once, several, without = (
        simulator_caveat(True, 0.01),
        simulator_caveat(True, 0.01, calls=2),
        simulator_caveat(False, 0.01),
    )
    assert [" 0.005 s" in caveat for caveat in (once, several, without)] == [True, False, False]
    assert ["half" in caveat for caveat in (once, several, without)] == [True, True, False]
    assert ["not at half" in caveat for caveat in (once, several, without)] == [False, True, False]
