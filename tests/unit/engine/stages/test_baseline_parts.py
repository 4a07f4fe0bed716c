"""A case of a baseline is evaluated on the obstacles and faults on which it was found, wherever they are listed."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.checked import lists as listed
from campaigns.checked.check import parameters
from campaigns.checked.units import differing, fixed
from campaigns.claims.stages.earlier_run import certain, other_index, other_seed, renumbered, unidentified, unknown
from campaigns.results import Finding
from campaigns.results.baselines import with_baseline
from tests.given import verdict_evidence as given
from tests.given.baseline_stage import context, ran
from tests.given.case_campaigns import searching
from worker.engine.search.base import Floats
from worker.evidence.audit import limits, reevaluation
from worker.evidence.audit import lists as again
from worker.running.catalogue.installed import catalogue


def walker(x: float, y: float, **values: float) -> dict[str, Any]:
    place = {"position": {"x": x, "y": y}, "goal": {"x": 0.0, "y": 6.0}}
    return {"component": "moving_circle", "parameters": {**place, "speed": 1.0, "radius": 0.3, **values}}


def wide(part: dict[str, Any]) -> dict[str, Any]:
    return {**part, "parameters": {**part["parameters"], "radius": 0.4}}


A, B, C = walker(6.0, 1.0), walker(3.0, 9.0), walker(12.0, -3.0)
POST = {"component": "circle", "parameters": {"position": {"x": 4.0, "y": 4.0}, "radius": 0.5}}
BLACKOUT = {"component": "blackout", "parameters": {"at": 8.0, "duration": 0.2}}
DROPOUT = {"component": "dropout", "parameters": {"at": 0.5, "duration": 0.2}}
SPEED, AT, MASS = {"low": 0.8, "high": 1.4}, {"low": 0.0, "high": 20.0}, {"low": 4.0, "high": 6.0}
LOST = unidentified("obstacles.0", "R-0001", "moving_circle")
CASE = {"speed": 1.3, "at": 3.0, "m": 6.0, "position.x": 5.0}


def flat(points: Floats) -> Floats:
    return np.asarray(1.0 + points.sum(axis=1))


def asked(parts: list[dict[str, Any]], varied: list[str], name: str = "obstacles") -> Campaign:
    bounds = {"speed": SPEED, "at": AT, "position.x": {"low": 0.0, "high": 20.0}}
    uncertain = {f"{name}.{path}": bounds[path.partition(".")[2]] for path in varied}
    return searching(
        {"method": "direct", "evaluations": 100},
        **{f"scenario__{name}": parts},
        uncertain={"vehicle.m": MASS, **uncertain},
    )


def compared(then: Campaign, now: Campaign) -> Campaign:
    values = {path: CASE[path.partition(".")[2].lstrip("0123456789.")] for path in then.uncertain}
    findings: list[Finding] = [given.finding(0.4, parameters=values, point=[])]
    known = catalogue()
    return with_baseline(now, "R-0001", then, findings, differing(then, known, now, known), fixed(then, known))


def audits(made: Campaign, index: int | None) -> bool:
    """Whether the audit evaluates the case if the stage does, on the same parts."""
    known, baseline = parameters(made, catalogue()), made.baseline
    bounds = {path: uncertain.interval(known[path][1]) for path, uncertain in made.uncertain.items()}
    random = [path for path in known if path.endswith(".seed")]
    run: Any = SimpleNamespace(
        campaign=made, known=known, bounds=bounds, fixed_seeds=[], random=random, wording=limits.PARTS
    )
    assert baseline is not None
    nominal = {path: value for path, (_, value) in known.items()}
    parts = listed.matched(listed.Listed.of_baseline(baseline), listed.Listed.of(made, nominal))
    return again.parts(run) == parts and reevaluation._possible(run, baseline.cases[0]) is (index is not None)


@pytest.mark.parametrize(
    ("then", "varied", "now", "here", "path", "why"),
    [
        ([A, B, POST], ["0.speed"], [A, B, POST], ["0.speed"], "obstacles.0.speed", ""),
        ([A, B, POST], ["0.speed"], [B, A, POST], ["1.speed"], "obstacles.1.speed", ""),
        ([A, B, POST], ["0.speed"], [POST, C, B, A], ["3.speed"], "obstacles.3.speed", ""),
        ([C, A, B, POST], ["1.speed"], [A, B, POST], ["0.speed"], "obstacles.0.speed", ""),
        ([A, POST], ["0.speed"], [A, POST, C], ["0.speed"], "obstacles.0.speed", ""),
        ([A, B], ["0.speed", "1.speed"], [B, A], ["0.speed", "1.speed"], "obstacles.1.speed", ""),
        ([A, A], ["0.speed", "1.speed"], [A, A], ["0.speed", "1.speed"], "obstacles.0.speed", ""),
        ([A, POST], ["0.speed"], [walker(6.5, 1.0), POST], ["0.speed"], "obstacles.0.speed", ""),
        ([A, POST], ["0.position.x"], [C, A, POST], ["1.position.x"], "obstacles.1.position.x", ""),
        # What was uncertain is another part's now.
        ([A, B, POST], ["0.speed"], [B, A, POST], ["0.speed"], "", certain("obstacles.1.speed", 1.3, 1.0)),
        ([A, B, POST], ["0.speed"], [C, A, B, POST], ["0.speed"], "", unknown("obstacles.0.speed", "R-0001")),
        ([C, A, B, POST], ["1.speed"], [A, B, POST], ["1.speed"], "", certain("obstacles.0.speed", 1.3, 1.0)),
        # It is no part of this campaign, or may be several.
        ([A, B, POST], ["0.speed"], [B, POST], ["0.speed"], "", LOST),
        ([A, POST], ["0.speed"], [POST, A, A], ["1.speed"], "obstacles.1.speed", ""),
        ([A, POST], ["0.speed"], [POST, A, A], ["1.speed", "2.speed"], "", LOST),
        ([A, B, POST], ["0.speed"], [B, walker(6.5, 1.0), POST], ["0.speed"], "", LOST),
        ([A, POST], ["0.speed"], [C, walker(6.5, 1.0), POST], ["0.speed"], "", LOST),
        # All were changed, and another one is closer than the one at the same index.
        ([A, B, POST], ["0.speed"], [wide(A), wide(B), POST], ["0.speed"], "obstacles.0.speed", ""),
        ([A, B, POST], ["0.speed"], [wide(B), wide(A), POST], ["0.speed"], "", LOST),
        ([A, B, POST], ["0.speed"], [wide(B), C, POST], ["0.speed"], "", LOST),
    ],
)
def test_a_case_is_evaluated_on_the_obstacle_on_which_it_was_found(
    then: list[Any], varied: list[str], now: list[Any], here: list[str], path: str, why: str
) -> None:
    made = compared(asked(then, varied), asked(now, here))
    (case,) = ran(context(made, flat)).cases
    assert (case.index is None) is bool(why)
    assert why in case.reason
    assert why or case.parameters[path] in (1.3, 5.0)
    assert audits(made, case.index)


@pytest.mark.parametrize(
    ("then", "varied", "now", "here", "evaluated"),
    [
        ([BLACKOUT, DROPOUT], ["0.at"], [DROPOUT, BLACKOUT], ["1.at"], True),
        ([BLACKOUT, DROPOUT], ["0.at", "1.at"], [DROPOUT, BLACKOUT], ["0.at", "1.at"], True),
        ([BLACKOUT, DROPOUT], ["1.at"], [DROPOUT], ["0.at"], True),
        ([BLACKOUT], ["0.at"], [DROPOUT], ["0.at"], False),
        ([BLACKOUT, DROPOUT], ["1.at"], [BLACKOUT], ["0.at"], False),
    ],
)
def test_a_case_has_its_own_fault(
    then: list[Any], varied: list[str], now: list[Any], here: list[str], evaluated: bool
) -> None:
    made = compared(asked(then, varied, "faults"), asked(now, here, "faults"))
    (case,) = ran(context(made, flat)).cases
    assert (case.index is not None) is evaluated
    assert audits(made, case.index)


def test_the_sentence_states_where_a_part_is_listed_here() -> None:
    made = compared(asked([A, B, POST], ["0.speed"]), asked([POST, A], ["1.speed"]))
    assert other_index("obstacles.0", "R-0001", "obstacles.1") in ran(context(made, flat)).text


def test_a_baseline_that_does_not_store_its_parts_has_none_that_is_here() -> None:
    """Those of earlier versions; what a case has of other parameters is compared."""
    now = asked([A, POST], ["0.speed"])
    for then, why in ((now, unidentified("obstacles.0", "R-0001", "")), (asked([A], []), "")):
        made = compared(then, now if why else asked([A], []))
        document = made.document()
        del document["baseline"]["parts"]
        (case,) = ran(context(load_document(document), flat)).cases
        assert case.reason.startswith(why)
        assert (case.index is None) is bool(why)


def test_the_noise_of_a_part_is_drawn_by_its_number() -> None:
    """A sensor that is listed first takes the noise of the one that was."""
    noise, other = ({"component": "sensor_noise", "parameters": {"sigma": sigma}} for sigma in (0.01, 0.02))
    then, first, last = (asked(parts, [], "faults") for parts in ([noise], [other, noise], [noise, other]))
    (case,) = ran(context(compared(then, first), flat)).cases
    assert renumbered("faults.0", "R-0001") in case.reason
    assert audits(compared(then, first), case.index)
    (case,) = ran(context(compared(then, last), flat)).cases
    assert case.index == 0
    assert audits(compared(then, last), case.index)


def test_the_noise_of_a_part_is_drawn_by_its_own_seed() -> None:
    """That a case is none with another realisation shows no change."""
    then, now = (
        asked([{"component": "sensor_noise", "parameters": {"sigma": sigma, "seed": seed}}], [], "faults")
        for sigma, seed in ((0.01, 0), (0.01, 7))
    )
    (case,) = ran(context(compared(then, now), flat)).cases
    assert case.reason == other_seed("faults.0.seed", 0.0, 7.0)
    assert audits(compared(then, now), case.index)
    louder = asked([{"component": "sensor_noise", "parameters": {"sigma": 0.02, "seed": 0}}], [], "faults")
    (case,) = ran(context(compared(then, louder), flat)).cases
    assert case.index == 0
    assert audits(compared(then, louder), case.index)
