"""Classes of attack on a verdict, each a generator of campaigns from a seed, with known permitted outcomes.

Where the truth can be had it comes from brute force: a dense set of simulations at half the step, apart from every
stage of a run. `tests/adversary/attack.py` runs them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.results.base import OK
from clearance.testing.problems import Problem
from tests.given.case_campaigns import document

NOT_CLEARED = frozenset({"violated", "inconclusive", "refused"})
VIOLATED = frozenset({"violated"})
ANY = NOT_CLEARED | {"cleared"}

SEARCHES = (
    {"method": "direct", "evaluations": 300},
    {"method": "global_clustering", "evaluations": 300},
    {"method": "sqp", "evaluations": 200, "starts": [{}]},
)
MASSES: dict[str, Any] = {"vehicle.m": {"plus_minus": "20%"}, "vehicle.J": {"plus_minus": "20%"}}


@dataclass(frozen=True)
class Attack:
    """A campaign as a document, and the outcomes that do not claim too much; `refused` is one that `check` stops."""

    name: str
    document: dict[str, Any]
    may: frozenset[str]


def campaign(name: str, random: np.random.Generator, may: frozenset[str], **changes: Any) -> Attack:
    """Case 1 with these changes: searches of a few hundred evaluations, a small sample, its own seed."""
    stages = {
        "sensitivity": {"points": 9},
        "search": [*SEARCHES],
        "certify": {"samples": 100},
        "validate": {"neighbours": 40, "evaluations": 20_000},
    }
    given = {
        "stages": stages,
        "uncertain": MASSES,
        "criterion__from_centre": True,
        "scenario__horizon": 8.0,
        "seed": int(random.integers(1, 2**31)),
    }
    made = document(**given | changes)
    return Attack(name, made | {"name": name, "published": []}, may)


def circle(x: float, y: float, radius: float = 0.1) -> dict[str, Any]:
    return {"component": "circle", "parameters": {"position": {"x": x, "y": y}, "radius": radius}}


def avoider(k_rep: float) -> dict[str, Any]:
    return {"component": "potential_field", "parameters": {"k_att": 5.0, "k_rep": k_rep, "d_0": 2.0}}


def slit_on_a_slice(random: np.random.Generator) -> Attack:
    """An intruder that meets the vehicle for a sliver of its bounds only, on the slices through the worst case."""
    reach = float(random.uniform(800.0, 1500.0))
    at = float(random.uniform(0.5, 4.0))
    moving = {
        "component": "moving_circle",
        "parameters": {
            "position": {"x": reach, "y": at},
            "goal": {"x": -50000.0, "y": at},
            "speed": 20.0,
            "radius": 0.1,
        },
    }
    uncertain = MASSES | {
        "obstacles.1.position.x": {"low": reach - 1500.0, "high": reach + 1500.0},
        "obstacles.1.position.y": {"low": at - 800.0, "high": at + 800.0},
    }
    obstacles = [circle(3.0, 5.0), moving]
    return campaign(
        "slit on a slice", random, ANY, scenario__obstacles=obstacles, uncertain=uncertain,
        scenario__avoider=avoider(0.0), criterion__threshold=float(random.uniform(0.3, 0.9)), stages__certify=None,
    )  # fmt: skip


def nobody_searched(random: np.random.Generator) -> Attack:
    """Two global methods whose budgets are below anything that could be called a search."""
    budgets = [int(random.integers(1, 50)) for _ in range(2)]
    searches = [{"method": m, "evaluations": n} for m, n in zip(("direct", "genetic"), budgets, strict=True)]
    threshold = float(random.uniform(0.1, 0.9))
    return campaign("nobody searched", random, NOT_CLEARED, stages__search=searches, criterion__threshold=threshold)


def horizon_too_short(random: np.random.Generator) -> Attack:
    """The horizon ends before the closest approach, which case 1 has at 3.6 to 5 s."""
    horizon = round(float(random.uniform(0.5, 3.0)), 1)
    return campaign("horizon too short", random, NOT_CLEARED, scenario__horizon=horizon, criterion__threshold=0.3)


def never_moves(random: np.random.Generator) -> Attack:
    """The goal is where the vehicle starts, or next to it."""
    near = float(random.choice([0.0, 1e-3, 1e-2]))
    return campaign("never moves", random, NOT_CLEARED, scenario__goal={"x": near, "y": 0.0}, criterion__threshold=0.5)


def out_of_reach(random: np.random.Generator) -> Attack:
    """The obstacle is nowhere near the path."""
    angle, far = random.uniform(0, 2 * math.pi), random.uniform(30.0, 1000.0)
    away = circle(far * math.cos(angle), far * math.sin(angle), 0.5)
    return campaign("obstacle out of reach", random, NOT_CLEARED, scenario__obstacles=[away], criterion__threshold=0.6)


def no_avoidance(random: np.random.Generator) -> Attack:
    """No avoidance, and the obstacle is next to the path."""
    beside = circle(float(random.uniform(1.0, 3.0)), float(random.uniform(4.5, 6.0)), 0.3)
    return campaign(
        "no avoidance", random, NOT_CLEARED, scenario__obstacles=[beside], scenario__avoider=avoider(0.0),
        criterion__threshold=0.4,
    )  # fmt: skip


def no_influence(random: np.random.Generator) -> Attack:
    """The uncertain parameter changes nothing that is measured."""
    uncertain = {"controller.N": {"low": 14.999999, "high": 15.000001}}
    return campaign(
        "no influence", random, NOT_CLEARED, uncertain=uncertain, criterion__threshold=float(random.uniform(0.1, 0.9))
    )


def collision(random: np.random.Generator) -> Attack:
    """Straight through a post for some of its places: d_min is 0, of which every fraction is 0."""
    x, wide = float(random.uniform(1.5, 4.0)), float(random.uniform(0.8, 2.0))
    uncertain = {"obstacles.0.position.y": {"low": -wide, "high": wide}, "vehicle.m": {"low": 4.0, "high": 6.0}}
    return campaign(
        "collision", random, VIOLATED, scenario__obstacles=[circle(x, 0.9 * wide)], uncertain=uncertain,
        scenario__goal={"x": 6.0, "y": 0.0}, scenario__avoider=avoider(0.0),
        criterion__threshold=float(random.uniform(0.2, 0.7)),
    )  # fmt: skip


def side_switch(random: np.random.Generator) -> Attack:
    """An avoider that changes sides: the worst ridge is a discontinuity whose position depends on the integrator."""
    start = {"x": float(random.uniform(0.1, 0.4)), "y": float(random.uniform(-0.4, -0.1)), "theta": 0.0}
    return _switching("side switch", random, start, float(random.uniform(1.617, 1.622)))


def mild_violation(random: np.random.Generator) -> Attack:
    """The same avoider at a threshold above every integration: by most they violate by less than as evaluated."""
    start = {"x": float(random.uniform(0.1, 0.4)), "y": float(random.uniform(-0.4, -0.1)), "theta": 0.0}
    return _switching("mild violation", random, start, float(random.uniform(1.625, 1.75)))


def _switching(name: str, random: np.random.Generator, start: dict[str, float], threshold: float) -> Attack:
    uncertain = MASSES | {"start.x": {"low": -0.5, "high": 0.5}, "start.y": {"low": -0.5, "high": 0.5}}
    return campaign(
        name, random, NOT_CLEARED, scenario__avoider={"component": "gnron", "parameters": {}},
        scenario__start=start, scenario__goal={"x": 8.0, "y": 8.0}, uncertain=uncertain, scenario__horizon=12.0,
        criterion__threshold=threshold,
    )  # fmt: skip


def one_realisation(random: np.random.Generator) -> Attack:
    """Sensor noise of which one realisation is stated; half of the others violate."""
    sample = {"samples": 100} if random.random() < 0.7 else None
    return campaign(
        "one noise realisation", random, NOT_CLEARED,
        scenario__faults=[{"component": "sensor_noise", "parameters": {"sigma": float(random.uniform(0.14, 0.2))}}],
        scenario__guidance={"period": 0.1}, scenario__realisations={"seeds": [int(random.integers(1, 1000))]},
        criterion__threshold=0.888, stages__certify=sample,
    )  # fmt: skip


def mean_of_realisations(random: np.random.Generator) -> Attack:
    """The mean over noise realisations is above the threshold, although single ones are not."""
    seeds = [int(s) for s in random.choice(1000, 4, replace=False)]
    return campaign(
        "mean of realisations", random, NOT_CLEARED,
        scenario__faults=[{"component": "sensor_noise", "parameters": {"sigma": 0.15}}],
        scenario__guidance={"period": 0.1}, scenario__realisations={"seeds": seeds, "combine": "mean"},
        criterion__threshold=float(random.uniform(0.7, 0.85)),
    )  # fmt: skip


def mostly_excluded(random: np.random.Generator) -> Attack:
    """Most of the bounds start within the threshold and are excluded; with or without a sample."""
    fast = {
        "component": "moving_circle",
        "parameters": {"position": {"x": 1.0, "y": 0.0}, "goal": {"x": 900.0, "y": 0.0}, "speed": 50.0, "radius": 0.1},
    }
    uncertain = {
        "vehicle.m": {"low": 4.0, "high": 6.0},
        "obstacles.1.position.x": {"low": float(random.uniform(-0.2, 0.3)), "high": float(random.uniform(1.0, 1.1))},
    }
    given: dict[str, Any] = {} if random.random() < 0.7 else {"stages__certify": None}
    return campaign(
        "mostly excluded", random, NOT_CLEARED, scenario__obstacles=[circle(4.0, 4.0, 0.5), fast], uncertain=uncertain,
        criterion__threshold=0.9, agreement=float(random.choice([0.05, 0.1, 1.0])), **given,
    )  # fmt: skip


def tails(random: np.random.Generator) -> Attack:
    """A normal distribution that is mostly outside the bounds."""
    wide = float(random.uniform(0.2, 3.0))
    uncertain = {
        "vehicle.m": {"low": 4.9, "high": 5.1, "distribution": {"kind": "normal", "mean": 5.0, "deviation": wide}},
        "vehicle.J": {"low": 0.049, "high": 0.051},
    }
    return campaign("tails outside the bounds", random, NOT_CLEARED, uncertain=uncertain, criterion__threshold=0.9)


def mass_outside(random: np.random.Generator) -> Attack:
    """Normal distributions of which more than a twentieth is outside the bounds, mostly without a sample, often with a
    target that seems to permit it."""
    half, wide = float(random.uniform(0.05, 0.5)), float(random.uniform(0.6, 5.0))
    normal = {"kind": "normal", "mean": 5.0, "deviation": half * wide}
    uncertain = {
        "vehicle.m": {"low": 5.0 - half, "high": 5.0 + half, "distribution": normal},
        "vehicle.J": {"low": 0.049, "high": 0.051},
    }
    given: dict[str, Any] = {"stages__certify": None} if random.random() < 0.7 else {}
    if random.random() < 0.5:
        given["target_probability"] = float(random.uniform(0.5, 0.999))
    return campaign(
        "mass outside the bounds", random, NOT_CLEARED, uncertain=uncertain, criterion__threshold=0.5, **given
    )


def one_family(random: np.random.Generator) -> Attack:
    """Methods that divide the box by the same rule and miss the same cases, by any of their names."""
    names = ["direct", "direct_l", "hybrid_direct", "nlopt_global", "nlopt_global"]
    chosen = random.choice(names, int(random.integers(2, 5)), replace=False)
    variants = ("direct", "direct_l", "direct_l_rand", "orig_direct", "orig_direct_l", "direct_noscal")
    searches = [
        {"method": str(name), "evaluations": 400}
        | ({"options": {"algorithm": str(random.choice(variants))}} if name == "nlopt_global" else {})
        for name in chosen
    ]
    threshold = float(random.uniform(0.3, 0.8))
    return campaign("one family", random, NOT_CLEARED, stages__search=searches, criterion__threshold=threshold)


def through_a_wall(random: np.random.Generator) -> Attack:
    """Through a wall far from its centre, at a threshold within the wall's reach."""
    length, k_rep = float(random.uniform(10.0, 20.0)), float(random.choice([0.0, 4.0]))
    wall = {
        "component": "box",
        "parameters": {
            "position": {"x": 1.0 + length / 2, "y": 3.5}, "length": length, "width": 0.2, "angle": 0.0,
        },
    }  # fmt: skip
    return campaign(
        "through a wall", random, NOT_CLEARED, scenario__obstacles=[wall], scenario__avoider=avoider(k_rep),
        criterion__threshold=float(random.uniform(0.1, 2.0)), criterion__from_centre=False,
    )  # fmt: skip


def aliased(random: np.random.Generator) -> Attack:
    """An obstacle that orbits once per step: at every step and half step it is at the same position."""
    speed = 1000.0
    way = speed * 0.0025 / (2 * math.pi)
    orbiting = {
        "component": "orbiting_circle",
        "parameters": {
            "centre": {"x": float(random.uniform(3.85, 3.95)), "y": 4.0}, "way": way, "phase": 0.0, "speed": speed,
            "radius": 0.1,
        },
    }  # fmt: skip
    return campaign(
        "aliased orbit", random, NOT_CLEARED, scenario__obstacles=[orbiting], scenario__avoider=avoider(0.0),
        criterion__threshold=0.4, scenario__horizon=6.0,
    )  # fmt: skip


def near_the_worst(random: np.random.Generator) -> Attack:
    """An honest campaign whose threshold is close to its worst case, above or below, as determined by brute force."""
    x, y = random.uniform(3.6, 4.4, 2)
    uncertain = MASSES | {"avoider.k_rep": {"low": 3.0, "high": 5.0}}
    made = campaign(
        "near the worst", random, ANY, scenario__obstacles=[circle(float(x), float(y))], uncertain=uncertain,
        stages__certify={"samples": 60},
    )  # fmt: skip
    lowest = brute_force(load_document(made.document), 7)
    nominal = brute_force(load_document(made.document), 1)
    threshold = lowest + float(random.uniform(-0.3, 0.3)) * max(nominal - lowest, 1e-3)
    document = made.document | {"criterion": made.document["criterion"] | {"threshold": threshold}}
    return Attack(made.name, document, ANY if lowest > threshold else NOT_CLEARED)


def coarse_step(random: np.random.Generator) -> Attack:
    """A step so long that the worst case differs by it, and a threshold between the two: a violation that only the step
    has, or one that it hides."""
    step = float(random.choice([0.008, 0.01]))
    made = campaign(
        "coarse step", random, ANY, scenario__obstacles=[circle(*random.uniform(3.6, 4.4, 2).tolist())],
        scenario__step=step, scenario__guidance={"period": step}, stages__certify={"samples": 60},
    ).document  # fmt: skip
    coarse, fine = (brute_force(load_document(made), 9, finer) for finer in (1, 64))
    threshold = coarse + float(random.uniform(0.3, 0.7)) * (fine - coarse)
    may = frozenset({"inconclusive", "refused"}) if fine > coarse else NOT_CLEARED
    return Attack("coarse step", made | {"criterion": made["criterion"] | {"threshold": threshold}}, may)


def brute_force(asked: Campaign, points: int, finer: int = 2) -> float:
    """The lowest cost of a full grid with so many points on every axis, at half the step or finer; of one, the nominal
    cost."""
    problem = Problem(asked)
    axis = np.linspace(0.0, 1.0, points)
    grid = np.stack(np.meshgrid(*[axis] * problem.dimension, indexing="ij"), -1).reshape(-1, problem.dimension)
    flown = problem.nominal_point[None, :] if points == 1 else grid
    batch, _ = problem.system.simulate_vectors(problem.vectors(flown), problem.system.step / finer)
    return float(np.min(batch.costs[batch.status == OK, 0], initial=np.inf))


CLASSES: tuple[Callable[[np.random.Generator], Attack], ...] = (
    slit_on_a_slice, nobody_searched, horizon_too_short, never_moves, out_of_reach, no_avoidance, no_influence,
    collision, side_switch, one_realisation, mean_of_realisations, mostly_excluded, tails, through_a_wall, aliased,
    near_the_worst, mass_outside, one_family, coarse_step, mild_violation,
)  # fmt: skip
