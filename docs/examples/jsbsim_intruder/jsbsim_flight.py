"""A Cessna 172 of JSBSim under its own autopilot meets an intruder and avoids it: a program of JSON lines.

Every evaluation loads the aircraft again, so that it depends on its parameters only. The autopilot of c172x holds
heading and altitude; once a second the avoider `closest_approach` of Clearance, in plain Python, changes the heading
to hold. On request `separation` also records the trace.
"""

from __future__ import annotations

import json
import math
import os
import sys
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

try:
    import jsbsim
except ModuleNotFoundError as error:
    sys.exit(
        f"the package {error.name} is not installed; where Clearance is installed: pip install 'clearance[jsbsim]'"
    )

from worker.engine.components.avoiders.closest_approach import ClosestApproach, Goal, component

VERSION = "1.3.3"
"""Of JSBSim. It is part of this file, and so of the simulator's digest: another version gives other numbers."""
STEP = 1.0 / 60.0
RISES, SETTLES = 10.0, 20.0
"""Before the encounter: the wind rises, and the autopilot settles [s]."""
MEETS, ENDS = 40.0, 50.0
"""From the start of the encounter to the meeting, and to the end [s]."""
NEAREST = 500.0
"""A start closer than this is no encounter [m]."""
GUIDANCE = 60
"""Steps between two commands of the avoider: 1 s."""
RECORDED = 6
"""Steps between two rows of a trace: 0.1 s."""
FOOT, POUND, EARTH = 0.3048, 0.45359237, 6371000.0 + 1219.2
ALTITUDE = 4000.0
"""[ft], 1219.2 m"""
REAR_SEATS, ASYMMETRIC_STORE = (2, 3), 5
"""Point masses of c172x. Its file also has a store of 36 kg on one wing tip, which is taken off here."""


class Failed(Exception):
    """The flight gives no result; the message says why."""


class Excluded(Exception):
    """The flight shows nothing, because it begins too close to the intruder; the message says why."""


class State(NamedTuple):
    """Position [m] east, north, up and velocity over ground [m/s] east, north."""

    x: float
    y: float
    z: float
    vx: float
    vy: float


class Intruder(NamedTuple):
    """What the avoider sees of the other aircraft."""

    x: float
    y: float
    vx: float
    vy: float
    radius: float = 0.0


def loaded(p: Mapping[str, float]) -> jsbsim.FGFDMExec:
    """The aircraft, trimmed in level flight to the east, with heading and altitude hold engaged."""
    jsbsim.FGJSBBase().debug_lvl = 0
    plane = jsbsim.FGFDMExec(None)
    if not plane.load_model("c172x"):
        raise Failed("JSBSim cannot load its aircraft c172x; install the package jsbsim again")
    plane.set_output_filename(0, os.devnull)  # c172x writes a table of its flight to the working folder
    plane.disable_output()
    plane.set_dt(STEP)
    plane["simulation/randomseed"] = 1
    plane[f"inertia/pointmass-weight-lbs[{ASYMMETRIC_STORE}]"] = 0.0
    for seat in REAR_SEATS:
        plane[f"inertia/pointmass-weight-lbs[{seat}]"] = 0.5 * p["payload"] / POUND
    for name, value in (("h-sl-ft", ALTITUDE), ("vt-kts", 105.0), ("psi-true-deg", 90.0), ("gamma-deg", 0.0)):
        plane[f"ic/{name}"] = value
    plane.run_ic()
    plane["propulsion/set-running"] = -1
    plane["fcs/mixture-cmd-norm"] = 0.87
    try:
        plane.do_trim(1)
    except jsbsim.TrimFailureError:
        raise Failed("JSBSim found no trimmed level flight at 105 kt with these parameters") from None
    plane["ap/heading_setpoint"] = 90.0
    plane["ap/altitude_setpoint"] = ALTITUDE
    plane["ap/heading_hold"] = plane["ap/altitude_hold"] = 1.0
    return plane


def state(plane: jsbsim.FGFDMExec) -> State:
    """The state in axes fixed at the start, on the equator, where east and north are nearly straight."""
    found = State(
        EARTH * math.radians(plane["position/long-gc-deg"]),
        EARTH * math.radians(plane["position/lat-gc-deg"]),
        FOOT * plane["position/h-sl-ft"],
        FOOT * plane["velocities/v-east-fps"],
        FOOT * plane["velocities/v-north-fps"],
    )
    at = plane["simulation/sim-time-sec"]
    if not all(map(math.isfinite, found)):
        raise Failed(f"the state is not finite at {at:.2f} s")
    if abs(plane["attitude/phi-deg"]) > 75.0 or found.z < 600.0:
        raise Failed(f"loss of control at {at:.2f} s: bank above 75 degrees or 600 m of altitude lost")
    return found


def flown(plane: jsbsim.FGFDMExec, duration: float) -> Iterator[State]:
    """The states after each step."""
    for _ in range(round(duration / STEP)):
        if not plane.run():
            raise Failed(f"JSBSim stopped at {plane['simulation/sim-time-sec']:.2f} s")
        yield state(plane)


def settled(plane: jsbsim.FGFDMExec, p: Mapping[str, float]) -> State:
    """The state in which the encounter starts: JSBSim trims in still air, so the wind rises afterwards."""
    wind = {f"atmosphere/wind-{axis}-fps": p[f"wind_{axis}"] / FOOT for axis in ("north", "east")}
    for step, _ in enumerate(flown(plane, SETTLES)):
        for name, speed in wind.items():
            plane[name] = speed * min(1.0, step * STEP / RISES)
    for name, speed in wind.items():
        if abs(plane[name] - speed) > 1e-6:  # JSBSim ignores what is written to a property that is read-only
            raise Failed(f"JSBSim has {name} = {plane[name]:g}, not {speed:g} as set")
    return state(plane)


def meeting(own: State, p: Mapping[str, float]) -> Intruder:
    """The intruder that meets the own aircraft, if that flies straight on, MEETS seconds from now."""
    own_course = math.atan2(own.vx, own.vy)
    course = own_course + math.radians(p["intruder_angle"])
    vx, vy = p["intruder_speed"] * math.sin(course), p["intruder_speed"] * math.cos(course)
    right = (math.cos(own_course), -math.sin(own_course))
    x = own.x + (own.vx - vx) * MEETS + p["offset"] * right[0]
    y = own.y + (own.vy - vy) * MEETS + p["offset"] * right[1]
    return Intruder(x, y, vx, vy)


def measured(own: State, other: Intruder, p: Mapping[str, float]) -> Intruder:
    """The intruder as the sensor reports it: turned by the bias of the bearing, its speed off by the bias."""
    turn, faster = math.radians(p["bearing_bias"]), 1.0 + p["speed_bias"] / math.hypot(other.vx, other.vy)
    x, y = other.x - own.x, other.y - own.y
    return Intruder(
        own.x + x * math.cos(turn) + y * math.sin(turn),
        own.y - x * math.sin(turn) + y * math.cos(turn),
        other.vx * faster,
        other.vy * faster,
    )


def steered(plane: jsbsim.FGFDMExec, own: State, seen: Intruder, goal: Goal, p: Mapping[str, float]) -> None:
    """Give the autopilot the heading that leads to the course the avoider demands, at the present drift."""
    rules = ClosestApproach(math.hypot(own.vx, own.vy), 1.0, p["clearance"], p["horizon"], 0.0)
    (ux, uy), _ = component.steer(0.0, (own.x, own.y), (own.vx, own.vy), goal, (seen,), (), rules)
    drift = plane["attitude/psi-deg"] - math.degrees(math.atan2(own.vx, own.vy))
    plane["ap/heading_setpoint"] = (math.degrees(math.atan2(ux, uy)) + drift) % 360.0


def distance2(own: State, other: Intruder, t: float, altitude: float) -> float:
    return (own.x - other.x - other.vx * t) ** 2 + (own.y - other.y - other.vy * t) ** 2 + (own.z - altitude) ** 2


def recorded(plane: jsbsim.FGFDMExec, own: State, start: State, other: Intruder, t: float) -> dict[str, float]:
    """A row of the trace. It only reads, so that a flight with a trace is the same to the bit."""
    return {
        "time": t,
        "north": own.y - start.y,
        "east": own.x - start.x,
        "down": -own.z,
        "roll": plane["attitude/phi-deg"],
        "pitch": plane["attitude/theta-deg"],
        "heading": plane["attitude/psi-deg"],
        "intruder_north": other.y + other.vy * t - start.y,
        "intruder_east": other.x + other.vx * t - start.x,
        "intruder_down": -start.z,
        "distance": math.sqrt(distance2(own, other, t, start.z)),
    }


def refined(before: float, at: float, after: float) -> float:
    """The lowest value of the parabola through three samples, of which the middle one is the lowest."""
    bend = before - 2.0 * at + after
    return at if bend <= 0.0 else at - 0.125 * (after - before) ** 2 / bend


def separation(p: Mapping[str, float], trace: list[dict[str, float]] | None = None) -> dict[str, float]:
    """Simulate one encounter: the smallest distance, and the greatest deviation from the altitude held.

    trace: the list to which its rows are appended.
    """
    plane = loaded(p)
    own = settled(plane, p)
    start, other = own, meeting(own, p)
    far = 1e5 / math.hypot(own.vx, own.vy)
    goal = Goal(own.x + far * own.vx, own.y + far * own.vy)
    if math.hypot(other.x - own.x, other.y - own.y) < NEAREST:
        raise Excluded(f"the intruder starts less than {NEAREST:g} m away")
    squares, deviation = [distance2(own, other, 0.0, start.z)], 0.0
    steps = flown(plane, ENDS)
    for step in range(round(ENDS / STEP)):
        t = step * STEP
        if trace is not None and step % RECORDED == 0:
            trace.append(recorded(plane, own, start, other, t))
        if step % GUIDANCE == 0:
            now = other._replace(x=other.x + other.vx * t, y=other.y + other.vy * t)
            steered(plane, own, measured(own, now, p), goal, p)
        own = next(steps)
        squares.append(distance2(own, other, (step + 1) * STEP, start.z))
        deviation = max(deviation, abs(own.z - FOOT * ALTITUDE))
    if trace is not None:
        trace.append(recorded(plane, own, start, other, ENDS))
    k = min(range(len(squares)), key=squares.__getitem__)
    lowest = refined(*squares[k - 1 : k + 2]) if 0 < k < len(squares) - 1 else squares[k]
    return {"separation": math.sqrt(max(lowest, 0.0)), "altitude_deviation": deviation}


def answered(line: str) -> dict[str, Any]:
    """The answer to one line: the id of the request, and what `evaluated` returns."""
    asked = json.loads(line)
    return {"id": asked.get("id"), **evaluated(asked)}


def evaluated(asked: Mapping[str, Any]) -> dict[str, Any]:
    """Results, and their trace if it is requested, why the flight does not count, or an error."""
    if jsbsim.__version__ != VERSION:
        return {
            "error": f"jsbsim {jsbsim.__version__} is installed, and this example is written for {VERSION}: pip "
            f"install 'clearance[jsbsim]', or change VERSION in {__file__}"
        }
    try:
        rows: list[dict[str, float]] | None = [] if asked.get("trace") else None
        answer: dict[str, Any] = {"results": separation(asked["parameters"], rows)}
        return answer | ({"trace": {name: [row[name] for row in rows] for name in rows[0]}} if rows else {})
    except Excluded as error:
        return {"excluded": str(error)}
    except Failed as error:
        return {"error": str(error)}


if __name__ == "__main__":
    for line in sys.stdin:
        print(json.dumps(answered(line)), flush=True)
