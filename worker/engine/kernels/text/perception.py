"""Generates the perception code: true obstacles, the vehicle's measured state, obstacles as perceived."""

from __future__ import annotations

from worker.engine.kernels.text.scenario import Function, Scenario, tupled

ADDED = {"errors": ("NO_ERRORS", "both_errors"), "sight": ("CLEAR_SIGHT", "both_sights")}
"""Names in `views`: the neutral value of a path without faults, and the function that adds two effects."""


def bodies(s: Scenario) -> None:
    f = s.function("bodies(t, o, q, p)")
    for prefix, state in s.each(s.obstacles, "o").items():
        f.add(f"{_body(prefix)} = {f.call(prefix, s.component[prefix].body, 't', state, 'q')}")
    f.add(f"return {tupled(map(_body, s.obstacles))}")


def _body(prefix: str) -> str:
    return f"body_{prefix.partition('.')[2]}"


def measurements(s: Scenario) -> None:
    if s.senses:
        _perceived(s)
    f, vehicle = s.function("measurements(t, x, p)"), s.parts.vehicle
    errors = summed(s, f, "navigation", "errors", "t")
    f.add(f"xm = {f.call('vehicle', vehicle.measured, s.state['vehicle'], errors)}")
    f.add(f"q = {f.call('vehicle', vehicle.position, 'xm')}", f"v = {f.call('vehicle', vehicle.velocity, 'xm')}")
    f.add(f"return xm, q, v, {seen(s, f, 'q')}")


def air_data(s: Scenario) -> None:
    vehicle = s.parts.vehicle
    if vehicle.felt is None:
        return
    f = s.function("air_data(t, x, env, p)")
    errors = summed(s, f, "navigation", "errors", "t")
    f.add(f"felt = {f.call('vehicle', vehicle.felt, 'x', 'env')}")
    f.add(f"return {f.call('vehicle', vehicle.measured, 'felt', errors)}")


def seen(s: Scenario, f: Function, q: str) -> str:
    """The expression for the obstacles as perceived from the measured position q."""
    if not s.senses:
        return f"bodies(t, {s.state['obstacles']}, {q}, p)"
    return f"perceived(t, {s.state['obstacles']}, {f.call('vehicle', s.parts.vehicle.pose, 'xm')}, {q}, v, p)"


def summed(s: Scenario, f: Function, path: str, name: str, *arguments: str) -> str:
    """The variable that holds the sum of the effects of all faults on a path."""
    none, both = ADDED[name]
    prefixes = s.faults.get(path, [])
    for prefix in prefixes:
        effect = f.call(prefix, s.component[prefix].kernel, *arguments)
        f.add(f"{name} = {effect if prefix == prefixes[0] else f'{s.view(both)}({name}, {effect})'}")
    return name if prefixes else s.view(none)


def _perceived(s: Scenario) -> None:
    f, d = s.function("perceived(t, o, own, q, v, p)"), s.dimension
    late = _seen_at(s, f)
    if "perception" in s.faults:
        f.add(f"pose = {s.space('q')} + own[3:6]", f"speed = {s.space('v')}")
    for prefix, state in s.each(s.obstacles, "o").items():
        body = s.component[prefix].body
        # Past states of an obstacle are not stored: its position is extrapolated back along its current velocity.
        at, ahead = ("t", "when.ahead - (t - when.at)") if state != "()" else ("when.at", "when.ahead")
        at = at if late else "t"
        there = f.call(prefix, body, at, state, "q")
        f.add(f"there = {there}" if d == 3 else f"there = {s.view('solid2')}({there})")
        number = prefix.partition(".")[2]
        sight = summed(s, f, "perception", "sight", "t", f"{number}.0", "pose", "speed", "there")
        if late:
            f.add(f"sight = {s.view('moved_by')}({sight}, {ahead}, there.vx, there.vy, there.vz)")
        displaced = f.call(prefix, body, at, state, f"{s.view('shifted')}(q, sight)")
        f.add(f"{_body(prefix)} = {s.view('shown')}({displaced}, sight, q)")
    f.add(f"return {tupled(map(_body, s.obstacles))}")


def _seen_at(s: Scenario, f: Function) -> bool:
    """Add the observation instant, delayed by every timing fault in turn; returns whether there is any such fault."""
    prefixes = s.faults.get("timing", [])
    for prefix in prefixes:
        kernel = s.component[prefix].kernel
        if prefix == prefixes[0]:
            f.add(f"when = {f.call(prefix, kernel, 't')}")
        else:
            f.add(f"then = {f.call(prefix, kernel, 'when.at')}")
            f.add(f"when = {s.view('Seen')}(then.at, when.ahead + then.ahead)")
    return bool(prefixes)
