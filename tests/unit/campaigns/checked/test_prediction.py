"""The bound that a sample can show at best is known before a run: the check refuses or warns by it."""

from __future__ import annotations

import re
from typing import Any

import pytest

from campaigns import Campaign, check, rules
from campaigns.checked import best_bound, prediction
from campaigns.checked.check import ranges, simulation_problems
from clearance.testing.problems import Problem
from tests.given.case_campaigns import campaign
from worker.engine.stages import certify
from worker.engine.stages.parts import claims
from worker.running.catalogue.installed import catalogue

DIRECT = {"method": "direct", "evaluations": 10}
RANDOM = {"method": "monte_carlo", "evaluations": 400}


def normal(deviation: float) -> dict[str, Any]:
    """A parameter of 4 to 6 around 5."""
    return {"low": 4, "high": 6, "distribution": {"kind": "normal", "mean": 5, "deviation": deviation}}


def asked(deviation: float, certified: dict[str, Any] | None, target: float | None, *searches: Any) -> Campaign:
    """Case 1 with an uncertain mass."""
    of = {"vehicle.m": normal(deviation)}
    stages = {"stages__search": list(searches or [DIRECT]), "stages__certify": certified}
    return campaign(uncertain=of, target_probability=target, **stages)


def best(of: Campaign) -> best_bound.Best | None:
    return prediction.predicted(of, catalogue())


def ends_by_target(samples: int) -> dict[str, Any]:
    return {"samples": samples, "keep": "lowest", "until": "target"}


@pytest.mark.parametrize("deviation", [0.1, 0.3, 0.39, 0.5, 1.0, 1e9])
@pytest.mark.parametrize(
    ("samples", "target"),
    [(6, 0.4), (20, 0.4), (59, 0.05), (20_000, 0.05), (300, 0.01), (20_000, 0.01), (3_000_000, 1e-6)],
)
def test_a_sample_that_cannot_meet_its_target_is_refused_by_the_check_as_by_the_run(
    samples: int, deviation: float, target: float
) -> None:
    of = asked(deviation, ends_by_target(samples), target)
    problem = Problem(of)
    reached = claims.allowed(samples, target - problem.distributions.outside, of.confidence) >= 0
    found = check(of, catalogue())
    assert (found == []) is reached
    assert [*certify.stage.wrong(problem)] == found
    assert simulation_problems(of, catalogue()) == []
    if reached:
        return
    assert [(p.field, p.given) for p in found] == [("stages.certify.samples", f"{samples:,}")]
    assert ("draw " in found[0].message or "higher target" in found[0].message) is (
        problem.distributions.outside < target
    )
    advised = re.search(r"draw ([\d,]+) samples or more", found[0].message)
    if advised:
        assert check(asked(deviation, ends_by_target(int(advised[1].replace(",", ""))), target), catalogue()) == []


@pytest.mark.by_day(18)
@pytest.mark.parametrize("samples", [3, 59, 300])
@pytest.mark.parametrize("deviation", [0.1, 0.33, 1.0])
@pytest.mark.parametrize("target", [None, 0.001, 0.05, 0.3])
@pytest.mark.parametrize("source", ["certify", "search"])
def test_a_bound_above_what_is_required_is_a_warning(
    samples: int, deviation: float, target: float | None, source: str
) -> None:
    def made(size: int) -> Campaign:
        random = RANDOM | {"evaluations": size}
        if source == "certify":
            return asked(deviation, {"samples": size}, target)
        return asked(deviation, None, target, DIRECT, random)

    of = made(samples)
    assert check(of, catalogue()) == [], "it runs, to a bound that is above the target"
    found, outside = best(of), Problem(of).distributions.outside
    assert found is not None
    assert (found.source, found.samples) == (source, samples)
    assert found.upper_bound == pytest.approx(claims.bound(0, samples, of.confidence) + outside, rel=1e-12)
    warning = prediction.warning(found, of)
    assert (warning is None) is (found.upper_bound <= rules.required(target))
    advised = re.search(r"draw ([\d,]+) samples or more", warning or "")
    assert warning is None or bool(advised) is (outside < rules.required(target))
    if advised:
        enough = made(int(advised[1].replace(",", "")))
        larger = best(enough)
        assert larger is not None
        assert prediction.warning(larger, enough) is None


def test_the_sentence_has_the_bound_and_its_condition() -> None:
    few = best(asked(0.1, {"samples": 59}, None))
    assert few is not None
    assert re.findall(r"[\d.,]+", few.statement)[:3] == ["4.96", "95", "59"]
    assert all(word in few.statement for word in ("violates", "fails", "excluded"))
    tails = best(asked(1.0, {"samples": 20_000}, 0.05))
    assert tails is not None
    assert re.findall(r"[\d.,]+ %", tails.statement) == ["31.8 %", "95 %", "31.8 %"]


@pytest.mark.parametrize(
    ("searches", "samples"),
    [
        ([RANDOM], 400),
        ([DIRECT], None),
        ([DIRECT, RANDOM | {"options": {"sampling": "plain", "interval": 0.0}}], 400),
        ([RANDOM | {"options": {"sampling": "sobol"}}], None),
        ([RANDOM | {"options": {"sampling": "sobol"}}, RANDOM | {"evaluations": 90}], 90),
        ([RANDOM | {"options": {"interval": 0.1}}], None),
        # It gives a bound of its own, by as many samples as it takes.
        ([RANDOM | {"options": {"interval": 0.1}}, RANDOM], None),
    ],
)
def test_without_certify_the_bound_is_of_a_random_search_as_it_is_by_default(
    searches: list[dict[str, Any]], samples: int | None
) -> None:
    found = best(asked(0.1, None, None, *searches))
    assert (found and found.samples) == samples
    certified = best(asked(0.1, {"samples": 59}, None, *searches))
    assert certified is not None
    assert (certified.source, certified.samples) == ("certify", 59)


J = {"plus_minus": "20%"}


@pytest.mark.parametrize("deviation", [0.2, 1.0, 1e3, 1e9])
@pytest.mark.parametrize("correlated", [[], ["vehicle.m", "vehicle.J"], ["vehicle.J", "avoider.d_0"]])
def test_what_is_outside_is_as_in_the_run(deviation: float, correlated: list[str]) -> None:
    """Wide normal distributions, and correlations of parameters with and without tails, included."""
    position = {"low": 3.9, "high": 4.1, "distribution": {"kind": "normal", "mean": 4.0, "deviation": 0.1}}
    uncertain = {"vehicle.m": normal(deviation), "vehicle.J": J, "avoider.d_0": J, "obstacles.0.position.x": position}
    joined = [{"between": correlated, "value": 0.5}] if correlated else []
    of = campaign(uncertain=uncertain, correlations=joined, stages__search=[DIRECT])
    found = best_bound.outside(of, ranges(of, catalogue()))
    assert found is not None
    assert found == pytest.approx(Problem(of).distributions.outside, rel=1e-12)
    assert found > 0.3
    assert best_bound.outside(of, {}) is None
