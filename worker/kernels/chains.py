"""Components of which there may be several, as chains: obstacles, faults, environment, criteria.

Each link is a template of `links` bound to one component, its parameters' and states' slices, and the link before.
Start reading at `chains`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from worker.kernels import guidance, links, views
from worker.kernels.bind import bind
from worker.kernels.component import Criterion, Obstacle
from worker.kernels.layout import Parts, Place, Placed, channels


def chains(parts: Parts, places: Mapping[str, Place]) -> dict[str, Any]:
    """The slots of the glue that hold chains."""
    own = {prefix: {"Own": at.fields, "P0": at.first, "P1": at.last} for prefix, at in places.items()}
    slots = _faults(parts, own)
    suffix = parts.vehicle.dimension
    slots["blended"] = bind(getattr(guidance, f"blended{suffix}"), {})
    for name in ("shifted", "shown", "point", "solid"):
        slots[name] = bind(getattr(views, f"{name}{suffix}"), {})
    return slots | _environment(parts, own, slots) | _obstacles(parts, own, slots) | _criteria(parts, own, places)


def _obstacles(parts: Parts, own: dict[str, dict[str, Any]], slots: dict[str, Any]) -> dict[str, Any]:
    """All obstacles as they are, as they are seen, and how they move."""
    bodies = seen = bind(links.nothing, {})
    woken, moved = bind(links.no_wake, {}), bind(links.no_move, {})
    centres = bind(links.nothing, {})
    centre = {"centre": bind(views.centre3 if parts.vehicle.dimension == 3 else views.centre2, {})}
    sensed = {k: slots[k] for k in ("sight", "shifted", "shown", "point", "solid")}
    late = any(f.fault.path == "timing" for f in parts.faults)
    offset = 0
    for i, obstacle in enumerate(parts.obstacles):
        at = own[f"obstacles.{i}"] | {"X0": offset, "X1": offset + obstacle.states}
        link = at | {"body": obstacle.body}
        if i == 0:
            bodies = bind(links.first_body, link)
            seen = bind(links.first_seen, link | sensed | _timed(late, obstacle, slots))
            centres = bind(links.first_centre, centre)
        else:
            bodies = bind(links.more_bodies, link | {"before": bodies})
            timed = _timed(late, obstacle, slots)
            seen = bind(links.more_seen, link | sensed | timed | {"before": seen, "INDEX": i})
            centres = bind(links.more_centres, centre | {"before": centres, "INDEX": i})
        if obstacle.states:
            woken = bind(links.more_wakes, own[f"obstacles.{i}"] | {"wake": obstacle.wake, "before": woken})
            moved = bind(links.more_moves, at | {"move": obstacle.move, "before": moved})
        offset += obstacle.states
    return {
        "bodies": bodies,
        "perceived": seen,
        "centres": centres,
        "woken_obstacles": woken,
        "moved": moved,
    }


def _timed(late: bool, obstacle: Obstacle, slots: dict[str, Any]) -> dict[str, Any]:
    """At which instant an obstacle is seen, and how it is carried on from there."""
    if not late:
        return {"seen_at": bind(links.now, {}), "carried": bind(links.at_once, {})}
    solid = {"solid": slots["solid"]}
    if obstacle.states:
        back = solid | {"before": slots["seen_at"]}
        return {"seen_at": bind(links.now, {}), "carried": bind(links.carried_back, back)}
    return {"seen_at": slots["seen_at"], "carried": bind(links.carried_on, solid)}


def _faults(parts: Parts, own: dict[str, dict[str, Any]]) -> dict[str, Any]:
    """Perception, timing, navigation and actuators through every fault on them, in the campaign's order."""
    slots: dict[str, Any] = {
        "sight": bind(links.clear_sight, {}),
        "seen_at": bind(links.now, {}),
        "errors": bind(links.no_error, {}),
        "actuated": bind(links.as_commanded, {}),
        "rested": bind(links.no_rest, {}),
        "late_by": bind(guidance.in_time, {}),
    }
    paths: dict[str, tuple[str, Any, str]] = {
        "perception": ("sight", links.less_sight, "see"),
        "timing": ("seen_at", links.then, "delay"),
        "navigation": ("errors", links.more_error, "mistake"),
        "guidance": ("late_by", guidance.later, "wait"),
    }
    offset = 0
    for i, placed in enumerate(parts.faults):
        at = own[f"faults.{i}"]
        if placed.fault.path == "actuator":
            offset = _actuator(parts, placed, at, slots, offset)
        else:
            slot, template, kernel = paths[placed.fault.path]
            slots[slot] = bind(template, at | {kernel: placed.fault.kernel, "before": slots[slot]})
    return slots


def _actuator(parts: Parts, placed: Placed, at: dict[str, Any], slots: dict[str, Any], offset: int) -> int:
    fault = placed.fault
    link = at | {"INDEX": placed.on, "NEXT": placed.on + 1, "before": slots["actuated"], "act": fault.kernel}
    size = {"X0": offset, "X1": offset + fault.states, "N_U": len(parts.vehicle.inputs)}
    slots["actuated"] = bind(links.more_actuated, link | size)
    if fault.states:
        rest = {"INDEX": placed.on, "before": slots["rested"], "rest": fault.rest}
        slots["rested"] = bind(links.more_rests, at | rest)
    return offset + fault.states


def _environment(parts: Parts, own: dict[str, dict[str, Any]], slots: dict[str, Any]) -> dict[str, Any]:
    surroundings, woken = bind(links.still, {}), bind(links.no_wake, {})
    offset, drawing = 0, []
    for i, part in enumerate(parts.environment):
        at = own[f"environment.{i}"]
        size = {"X0": offset, "X1": offset + part.states}
        driven = bind(links.undriven, at | {"blow": part.blow})
        if part.draw is not None:
            drawn = bind(links.draw_own, at | {"draw": part.draw})
            drawing.append((drawn, part.draws))
            driven = bind(links.driven, at | {"blow": part.blow, "drawn": drawn})
        link = size | {"part": driven, "before": surroundings, "point": slots["point"]}
        surroundings = bind(links.more_surroundings, link)
        if part.states:
            woken = bind(links.more_wakes, at | {"wake": part.wake, "before": woken})
        offset += part.states
    return {"surroundings": surroundings, "woken_environment": woken, "drawing": tuple(drawing)}


def _criteria(parts: Parts, own: dict[str, dict[str, Any]], places: Mapping[str, Place]) -> dict[str, Any]:
    """The channels of all criteria side by side, and their costs; the costs begin with the one that decides."""
    stand = channels(parts).of
    readings: Any = None
    for prefix in stand:
        reading = _reading(parts, parts.criteria[prefix], own[prefix], places)
        readings = bind(links.more_readings, {"before": readings, "reading": reading}) if readings else reading
    costs: Any = None
    for prefix, criterion in parts.criteria.items():
        link = own[prefix] | {"value": criterion.value, "Y0": stand[prefix][0], "Y1": stand[prefix][1]}
        sign = {"SIGN": -1.0 if criterion.worse == "high" else 1.0}
        costs = bind(links.more_costs, link | sign | {"before": costs}) if costs else bind(links.first_cost, link)
    return {"readings": readings, "costs_of": costs}


def _reading(parts: Parts, criterion: Criterion, own: dict[str, Any], places: Mapping[str, Place]) -> Any:
    """The channels of one criterion at one instant."""
    dimension = parts.vehicle.dimension
    sample = {"sample": criterion.sample[dimension]}
    if criterion.of == "goal":
        goal = places["goal"]
        there = {"Goal": goal.fields, "G0": goal.first, "G1": goal.last}
        place = bind(views.place3 if dimension == 3 else views.place2, {})
        return bind(links.of_goal, own | sample | there | {"place": place})
    if criterion.of == "flight":
        vehicle = places["vehicle"]
        there = {"Vehicle": vehicle.fields, "V0": vehicle.first, "V1": vehicle.last}
        return bind(links.of_flight, own | sample | there | {"pose": parts.vehicle.pose})
    samples = bind(links.first_sample, sample)
    for i in range(1, len(parts.obstacles)):
        samples = bind(links.more_samples, sample | {"before": samples, "INDEX": i})
    return bind(links.of_obstacles, own | {"samples": samples})
