"""Every component: documented, limited, and unbreakable within its limits; compiled and plain it flies the same."""

from __future__ import annotations

import re

import numpy as np
import pytest

from campaigns import check
from campaigns.asked.load import load_document
from campaigns.results.base import EXCLUDED, FAILED, OK
from tests.contract.scenes import STEP, around, drawn, entry, near, own, problem
from worker.catalogue.installed import catalogue, components, source_of
from worker.kernels.component import Component, Criterion, Vehicle, declared
from worker.systems.problem import Problem

EACH = pytest.mark.parametrize("component", components().values(), ids=lambda c: f"{c.role}-{c.name}")

PURE = {"", "-", "N m^(3-n)"}
"""Units of numbers without a dimension, and one whose power is a parameter itself."""

UNIT = re.compile(r"(1/)?(\(?[A-Za-zµ%°]+[0-9]*( [A-Za-z]+[0-9]*)*\)?)(/(\(.+\)|[A-Za-z]+[0-9]*))?")


def test_there_are_components_of_every_kind() -> None:
    assert {role for role, _ in components()} >= {"vehicle", "controller", "avoider", "obstacle", "criterion"}
    assert len(catalogue().components) == len(components())


@EACH
def test_it_is_documented(component: Component) -> None:
    described = entry(component)
    assert described.title[0].isupper()
    assert len(described.text.splitlines()) >= 2, "the file's docstring tells what it is and where it comes from"
    assert described.text.splitlines()[0].endswith((".", ":"))
    assert (source_of(component).__doc__ or "").strip() == described.text
    if component.role in ("vehicle", "controller", "avoider", "criterion"):
        assert "Source: " in described.text


@EACH
def test_its_names_can_be_written_in_a_campaign(component: Component) -> None:
    described = entry(component)
    assert re.fullmatch(r"[a-z][a-z0-9_]*", described.name)
    assert source_of(component).__name__.rpartition(".")[2] == described.name
    for entries in (described.parameters, described.starts, described.goals):
        names = [p.name for p in entries]
        assert len(set(names)) == len(names)
        assert all(re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*(\.[A-Za-z0-9_]+)*", name) for name in names)


@EACH
def test_its_parameters_have_unit_text_and_limits(component: Component) -> None:
    for path, p in own(component).items():
        assert p.unit in PURE or UNIT.fullmatch(p.unit), f"{path}: what is the unit {p.unit!r}?"
        assert p.text[0].isupper(), path
        assert not p.text.endswith("."), path
        assert p.symbol, path
        assert -1e12 <= p.low < p.high <= 1e12, path
        assert p.default is None or p.low <= p.default <= p.high, path


CRITERIA = [c for (role, _), c in components().items() if role == "criterion"]


@pytest.mark.parametrize("criterion", CRITERIA, ids=lambda c: c.name)
def test_a_criterion_says_which_end_is_worse(criterion: Criterion) -> None:
    named = [p.name for p in declared(criterion.parameters)]
    assert entry(criterion).worse == criterion.worse
    assert entry(criterion).of == criterion.of
    assert (entry(criterion).dimension is None) == (set(criterion.sample) == {2, 3})
    assert "threshold" not in [p.name for p in entry(criterion).parameters]
    if criterion.worse == "low":
        assert named[0] == "threshold"
        assert criterion.excluded is not None
    else:
        assert "threshold" not in named


@pytest.mark.parametrize("criterion", [c for c in CRITERIA if c.worse == "high"], ids=lambda c: c.name)
def test_a_criterion_beside_the_one_that_decides_changes_nothing_of_it(criterion: Criterion) -> None:
    beside = problem(criterion)
    document = around(criterion) | {"objectives": []}
    alone = Problem(load_document(document))
    points = np.random.default_rng(5).random((21, 1))
    batch, _ = beside.fly(points)
    assert batch.costs.shape == (21, 2)
    assert batch.costs[:, 0].tobytes() == alone.fly(points)[0].costs[:, 0].tobytes()
    # Its sign is turned, so that every column is minimised.
    assert (batch.costs[:, 1] <= 0.0).all()


@EACH
def test_a_vehicle_tells_its_states_and_limits(component: Component) -> None:
    if not isinstance(component, Vehicle):
        return
    assert len({s.name for s in component.states}) == len(component.states)
    assert all(limit.text and not limit.text.endswith(".") for limit in component.limits)
    flown = problem(component)
    x = flown.loop.part("initial")(flown.loop.extend(flown.nominal))
    assert len(x) >= len(component.states)
    assert flown.loop.part("envelope")(x, flown.loop.extend(flown.nominal)) == 0.0


@EACH
def test_it_flies_with_the_first_others_that_fit(component: Component) -> None:
    made = load_document(around(component))
    assert check(made, catalogue()) == []
    batch, reasons = problem(component).fly(np.array([[0.0], [0.5], [1.0]]))
    assert batch.status.tolist() == [OK] * 3, reasons


@EACH
def test_within_its_limits_nothing_crashes_and_nothing_is_hidden(component: Component) -> None:
    flown, vectors = problem(component), drawn(component, 384)
    batch, reasons = flown.fly_vectors(vectors)
    ok = batch.status == OK
    assert np.isfinite(batch.costs[ok]).all()
    assert np.isnan(batch.costs[~ok]).all()
    assert batch.costs.shape == (len(vectors), len(flown.criteria))
    assert set(np.unique(batch.status)) <= {OK, FAILED, EXCLUDED}
    assert sorted(reasons) == np.flatnonzero(~ok).tolist()
    assert all(reason.startswith("the flight ") for reason in reasons.values())
    again, _ = flown.fly_vectors(vectors[::-1])
    assert again.costs[::-1].tobytes() == batch.costs.tobytes()


@EACH
def test_a_value_that_is_no_number_fails_the_flight_or_changes_nothing(component: Component) -> None:
    # NaN must never come out as a cost that looks like one; a parameter that this flight does not use may be anything.
    flown = problem(component)
    usual, _ = flown.fly_vectors(flown.nominal[None, :])
    for path in own(component):
        vector = flown.nominal.copy()
        vector[flown.paths[path]] = np.nan
        batch, _ = flown.fly_vectors(vector[None, :])
        assert batch.status[0] != OK or np.array_equal(batch.costs, usual.costs), path


@EACH
def test_compiled_it_flies_as_in_plain_python(component: Component) -> None:
    compiled, vectors, steps = problem(component), near(component, 16), 24
    plain = problem(component, compiled=False)
    one, other = (p.loop.fly(vectors, STEP, steps, traced=1) for p in (compiled, plain))
    assert one.status.tolist() == other.status.tolist()
    ok = one.status == 0.0
    assert ok.any()
    assert one.costs[ok] == pytest.approx(other.costs[ok], rel=1e-12, abs=1e-12)
    assert one.trace == pytest.approx(other.trace, rel=1e-9, abs=1e-9, nan_ok=True)


def test_a_far_obstacle_does_not_fail_a_flight() -> None:
    obstacle = components()["obstacle", "circle"]
    flown = problem(obstacle)
    vector = flown.vector({"obstacles.0.position.x": 1e6, "obstacles.0.position.y": 1e6})
    batch, reasons = flown.fly_vectors(vector[None, :])
    assert batch.status[0] == OK, reasons
