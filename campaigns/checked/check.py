"""Validates a campaign against the catalogue: known components and methods, units, each component's own limits.

Used by command line and API alike; the catalogue is data, so no physics is imported.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterator, Mapping

from campaigns.asked.criteria import criteria
from campaigns.asked.distributions import Uncertain, Uniform
from campaigns.asked.problem import MOST, Problem
from campaigns.asked.spec import Campaign, Part
from campaigns.asked.values import MAX_EVALUATIONS
from campaigns.catalogue import Catalogue, ComponentEntry, ParameterEntry, Role
from campaigns.checked import (
    attracted,
    best_bound,
    delays,
    effort,
    estimated,
    extents,
    frames,
    limits,
    options,
    orders,
    simulated,
    texts,
    uncertainty,
)
from campaigns.claims.numbers import interval
from campaigns.limits import CONFIDENCE_AT_LEAST, REALISATIONS, STORED_WHOLE

SEED = "seed"
"""The parameter of a random component that selects its realisation."""
_SEEDS = re.compile(r"(seeds?|random_?state|reali[sz]ations?|[._]rng)[_\d]*$", re.IGNORECASE)
"""How the names of parameters end that select one: seed, noise_seed, randomSeed2, random_state."""
RANDOM = ("environment", "fault")
"""The roles of components that may be random."""
LISTED: dict[str, Role] = {"obstacles": "obstacle", "environment": "environment", "faults": "fault"}
"""The lists of components in a scenario, and their roles."""


def check(campaign: Campaign, catalogue: Catalogue) -> list[Problem]:
    """The problems of the campaign under this catalogue, the first `MOST`; an empty list means that it is valid."""
    found = _first(itertools.chain(_check(campaign, catalogue), _meaning(campaign, catalogue)))
    # Of a campaign with other problems its distributions may have no probabilities.
    return found or best_bound.unattainable(campaign, ranges(campaign, catalogue))


def simulation_problems(campaign: Campaign, catalogue: Catalogue) -> list[Problem]:
    """The problems that prevent simulation with these components; stored runs are displayed if there are none.

    Other problems reported by `check` do not prevent simulation, but would make the numbers misleading.
    """
    return _first(_check(campaign, catalogue))


def _first(problems: Iterator[Problem]) -> list[Problem]:
    found = list(itertools.islice(problems, MOST + 1))
    return (
        found if len(found) <= MOST else [*found[: MOST - 1], Problem("", "", "and more problems; correct these first")]
    )


def parts(campaign: Campaign) -> Iterator[tuple[str, str, Role, Part]]:
    """The parts of a scenario: prefix of parameter paths, field in the file, role, part; empty for a simulator."""
    s = campaign.scenario
    if s is None:
        return
    yield "vehicle", "scenario.vehicle", "vehicle", s.vehicle
    yield "controller", "scenario.controller", "controller", s.controller
    yield "avoider", "scenario.avoider", "avoider", s.avoider
    for name, role in LISTED.items():
        for i, part in enumerate(getattr(s, name)):
            yield f"{name}.{i}", f"scenario.{name}.{i}", role, part
    c = campaign.criterion
    yield "criterion", "criterion", "criterion", Part(component=c.component, parameters=c.parameters)
    for i, objective in enumerate(campaign.objectives):
        yield f"objectives.{i}", f"objectives.{i}", "criterion", objective


def installed(campaign: Campaign, catalogue: Catalogue) -> Iterator[tuple[str, str, ComponentEntry, Part]]:
    """The parts whose component the catalogue has, with its entry in place of the role."""
    for prefix, field, role, part in parts(campaign):
        entry = catalogue.component(role, part.component)
        if entry is not None:
            yield prefix, field, entry, part


def parameters(campaign: Campaign, catalogue: Catalogue) -> dict[str, tuple[ParameterEntry, float]]:
    """Every parameter of the campaign by path, with its entry and nominal value; unknown components are omitted.

    A required parameter that is missing has the nominal value NaN; `check` reports it.
    """
    found: dict[str, tuple[ParameterEntry, float]] = simulated.parameters(campaign, catalogue)
    for prefix, _, entry, part in installed(campaign, catalogue):
        found.update(limits.valued(prefix, entry.parameters, part.parameters))
        if entry.role == "vehicle":
            found.update(limits.valued("start", entry.starts, campaign.given_scenario.start))
        if entry.role == "avoider":
            found.update(limits.valued("goal", entry.goals, campaign.given_scenario.goal))
    return found


def ranges(campaign: Campaign, catalogue: Catalogue) -> dict[str, tuple[float, float]]:
    """The lowest and the highest value of every parameter by path, equal where it is fixed, in its own unit."""
    known = parameters(campaign, catalogue)
    return {path: campaign.interval(path, nominal) for path, (_, nominal) in known.items()}


def seeded(campaign: Campaign, catalogue: Catalogue) -> list[str]:
    """The paths of the seeds: one for every part of the scenario that is random."""
    random = ((prefix, entry) for prefix, _, entry, _ in installed(campaign, catalogue) if entry.role in RANDOM)
    return [f"{prefix}.{p.name}" for prefix, entry in random for p in entry.parameters if p.name == SEED]


def selects_realisation(path: str) -> bool:
    """Whether a parameter of this name or path does, by its name."""
    return _SEEDS.search(f".{path}") is not None


def unvaried(campaign: Campaign, nominal: Mapping[str, float]) -> list[str]:
    """Those of a campaign's parameters, by path with their nominal values, that select a realisation, are not uniform
    over many whole numbers, and that no realisations vary."""
    seeds = (path for path in nominal if selects_realisation(path))
    varied = tuple(f"{name}." for name, role in LISTED.items() if role in RANDOM)
    realised = (path for path in seeds if not (path.startswith(varied) and path.endswith(f".{SEED}")))
    return [path for path in realised if not _many(campaign.uncertain.get(path), nominal[path])]


def _many(seed: Uncertain | None, nominal: float) -> bool:
    if seed is None or not isinstance(seed.distribution, Uniform):
        return False
    low, high = seed.interval(nominal)
    return math.floor(high) - math.ceil(low) + 1 >= REALISATIONS


def _check(campaign: Campaign, catalogue: Catalogue) -> Iterator[Problem]:
    if campaign.simulator is None:
        yield from _composed(campaign, catalogue)
    else:
        yield from simulated.simulated(campaign, campaign.simulator, catalogue)
    known = parameters(campaign, catalogue)
    unknown = _unknown(campaign, catalogue)
    for path, uncertain in campaign.uncertain.items():
        if not path.startswith(unknown):
            yield from uncertainty.bounded(path, uncertain, known)
    yield from uncertainty.correlated(campaign)
    yield from _searches(campaign, catalogue, known)
    yield from _certified(campaign)
    yield from attracted.attracted(campaign, catalogue)
    yield from estimated.estimated(campaign, bool(seeded(campaign, catalogue)))


def _composed(campaign: Campaign, catalogue: Catalogue) -> Iterator[Problem]:
    """The problems with the components of a scenario, each and together."""
    for _, field, role, part in parts(campaign):
        entry = catalogue.component(role, part.component)
        if entry is None:
            names = [c.name for c in catalogue.components if c.role == role]
            text = f"no such {role}; {texts.known(part.component, names)}"
            text = catalogue.why_not("component", part.component, text)
            yield Problem(f"{field}.component", part.component, text)
            continue
        yield from limits.refused(f"{field}.parameters", entry.parameters, part.parameters)
        if role == "vehicle":
            yield from limits.refused("scenario.start", entry.starts, campaign.given_scenario.start)
        if role == "avoider":
            yield from limits.refused("scenario.goal", entry.goals, campaign.given_scenario.goal)
    yield from _dimensions(campaign, catalogue)
    yield from _fits(campaign, catalogue)
    yield from criteria(campaign, catalogue)


def _meaning(campaign: Campaign, catalogue: Catalogue) -> Iterator[Problem]:
    yield from effort.excessive(campaign)
    yield from options.unsuited(campaign, catalogue)
    if campaign.confidence < CONFIDENCE_AT_LEAST:
        text = f"the confidence is too low to support a claim; give at least {CONFIDENCE_AT_LEAST:g}"
        yield Problem("confidence", f"{campaign.confidence!r}", text)
    if campaign.scenario is None:
        return
    known = parameters(campaign, catalogue)
    yield from extents.centres(campaign, catalogue, known)
    found = list(installed(campaign, catalogue))
    yield from frames.mismatched(campaign, catalogue, [(field, entry) for _, field, entry, _ in found])
    bounds = ranges(campaign, catalogue)
    yield from orders.broken(found, bounds)
    yield from delays.excessive(found, bounds)


def _unknown(campaign: Campaign, catalogue: Catalogue) -> tuple[str, ...]:
    """Prefixes of the paths of unknown components, for each of which one problem is enough."""
    if campaign.simulator is not None:
        return () if catalogue.simulator(campaign.simulator.name) else (f"{simulated.PREFIX}.",)
    also = {"vehicle": ("start.",), "avoider": ("goal.",)}
    return tuple(
        beginning
        for prefix, _, role, part in parts(campaign)
        if catalogue.component(role, part.component) is None
        for beginning in (f"{prefix}.", *also.get(role, ()))
    )


def _dimensions(campaign: Campaign, catalogue: Catalogue) -> Iterator[Problem]:
    found = [(field, entry) for _, field, entry, _ in installed(campaign, catalogue) if entry.dimension is not None]
    for field, entry in found[1:]:
        first = found[0][1]
        if entry.dimension != first.dimension:
            yield Problem(
                f"{field}.component",
                entry.name,
                f"has {entry.dimension} dimensions, the {first.role} {first.name!r} has {first.dimension}",
            )


def _fits(campaign: Campaign, catalogue: Catalogue) -> Iterator[Problem]:
    scenario = campaign.given_scenario
    controller = catalogue.component("controller", scenario.controller.component)
    vehicle = catalogue.component("vehicle", scenario.vehicle.component)
    if controller is not None and vehicle is not None and vehicle.name not in controller.fits:
        controlled = ", ".join(controller.fits)
        yield Problem(
            "scenario.controller.component",
            controller.name,
            f"this controller controls {controlled}, not {scenario.vehicle.component}",
        )
    yield from _placed(campaign, catalogue)
    yield from _realised(campaign, catalogue)
    avoider = catalogue.component("avoider", scenario.avoider.component)
    if controller is not None and avoider is not None and avoider.demand not in controller.demands:
        follows = " or ".join(controller.demands)
        text = f"it demands a {avoider.demand}; the controller {controller.name} follows a {follows}"
        yield Problem("scenario.avoider.component", avoider.name, text)
    if not scenario.obstacles:
        yield Problem("scenario.obstacles", "[]", "give at least one obstacle: the criterion reads distances to them")


def _placed(campaign: Campaign, catalogue: Catalogue) -> Iterator[Problem]:
    """Actuator faults name one of the vehicle's inputs; other faults name none."""
    vehicle = catalogue.component("vehicle", campaign.given_scenario.vehicle.component)
    for i, fault in enumerate(campaign.given_scenario.faults):
        entry = catalogue.component("fault", fault.component)
        if entry is None or vehicle is None:
            continue
        field = f"scenario.faults.{i}.on"
        if entry.path == "actuator" and fault.on not in vehicle.inputs:
            yield Problem(field, fault.on, f"name the input it acts on: {', '.join(vehicle.inputs)}")
        elif entry.path != "actuator" and fault.on:
            yield Problem(field, fault.on, f"a {entry.path} fault does not act on an input; remove this")
        if entry.path == "guidance" and campaign.given_scenario.guidance.period == 0:
            text = "only sampled guidance can be delayed; give scenario.guidance.period, or delay an actuator"
            yield Problem(f"scenario.faults.{i}.component", fault.component, text)


def _realised(campaign: Campaign, catalogue: Catalogue) -> Iterator[Problem]:
    """Seeds are given only if something is random, and are not searched over."""
    random = set(seeded(campaign, catalogue))
    seeds = campaign.given_scenario.realisations.seeds
    if len(seeds) > 1 and not random:
        text = "nothing in the scenario is random: all realisations are identical; remove this"
        yield Problem("scenario.realisations.seeds", str(seeds), text)
    certify = campaign.stages.certify
    if random and certify is not None and certify.keep == "all" and certify.samples > STORED_WHOLE:
        text = f"a sample of more than {STORED_WHOLE:,} draws that is stored whole repeats its noise: give keep: lowest"
        yield Problem("stages.certify.samples", f"{certify.samples:,}", text)
    for path in sorted(random & campaign.uncertain.keys()):
        text = "a seed selects a realisation and is not a quantity; list several seeds in scenario.realisations.seeds"
        yield Problem(f"uncertain.{path}", path, text)


def _searches(
    campaign: Campaign, catalogue: Catalogue, known: Mapping[str, tuple[ParameterEntry, float]]
) -> Iterator[Problem]:
    for i, search in enumerate(campaign.stages.search):
        field = f"stages.search.{i}"
        entry = catalogue.method(search.method)
        if entry is None:
            names = [m.name for m in catalogue.methods]
            text = f"no such method; {texts.known(search.method, names)}"
            yield Problem(f"{field}.method", search.method, catalogue.why_not("method", search.method, text))
            continue
        yield from options.refused(f"{field}.options", search.options, entry.options)
        if search.starts and not entry.starts:
            yield Problem(
                f"{field}.starts", f"{len(search.starts)} starts", f"{entry.title} takes no start points; remove them"
            )
        for j, start in enumerate(search.starts):
            for path, value in start.items():
                yield from _started(f"{field}.starts.{j}.{path}", path, value, campaign, known)


def _certified(campaign: Campaign) -> Iterator[Problem]:
    certify, dimension = campaign.stages.certify, len(campaign.uncertain)
    if certify is not None and certify.grid is not None and certify.grid.points**dimension > MAX_EVALUATIONS:
        most = int(MAX_EVALUATIONS ** (1 / dimension) + 1e-9)
        advice = f"at most {most} points per axis" if most >= 2 else "remove the grid"
        text = f"a full grid over {dimension} parameters would need more than {MAX_EVALUATIONS:,} evaluations; {advice}"
        yield Problem("stages.certify.grid.points", str(certify.grid.points), text)


def _started(
    field: str, path: str, value: float, campaign: Campaign, known: Mapping[str, tuple[ParameterEntry, float]]
) -> Iterator[Problem]:
    if path not in campaign.uncertain:
        yield Problem(field, path, f"not an uncertain parameter; {texts.known(path, campaign.uncertain)}")
    elif path in known:
        low, high = campaign.uncertain[path].interval(known[path][1])
        if not texts.within(value, low, high):
            yield Problem(field, texts.number(value), f"a start must be within the bounds {interval(low, high)}")
