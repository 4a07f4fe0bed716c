"""Two airliners in BlueSky resolve a conflict by its MVP method: a program of JSON lines.

BlueSky runs in this process, without windows, network and navigation data, and is reset before every evaluation. Its
files go into the folder of the slot. On request `separation` also records the trace.
"""

from __future__ import annotations

import contextlib
import json
import math
import sys
from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np

try:
    import bluesky
    from bluesky import navdatabase, tools
    from bluesky.stack.cmdparser import Command
except ModuleNotFoundError as error:
    sys.exit(
        f"the package {error.name} is not installed; where Clearance is installed: pip install 'clearance[bluesky]'"
    )

INSTALL = "pip install 'clearance[bluesky]'"
VERSION = "1.1.1"
"""Of BlueSky. It is part of this file, and so of the simulator's digest: another version gives other numbers."""
OPENAP = "2.6.2"
"""Of its model of aircraft performance, likewise. Without it BlueSky takes another model, with a line in its output."""
TYPE = "A320"
MEETS, ENDS, STEP = 180.0, 300.0, 1.0
"""Time at which the tracks cross, and of the end; step of BlueSky [s]."""
ALTITUDE, RADIUS = 9144.0, 6371000.0
"""Flight level 300 and radius of BlueSky's sphere [m]."""
ZONE = 9260.0
"""Radius of the protected zone, 5 nautical miles [m]."""
NAMES = ("OWN", "OTHER")


class Failed(Exception):
    """The encounter gives no result; the message says why."""


class Excluded(Exception):
    """The encounter shows nothing, because it begins as a conflict that nothing could avoid; the message says why."""


class NoNavigationData(navdatabase.Navdatabase):
    """Nothing here refers to waypoints, and reading them takes seconds at every reset."""

    def reset(self) -> None:
        pass


def initialised() -> str:
    """BlueSky in this process, whose output goes to the standard error stream; why it cannot be used, or empty."""
    from bluesky.traffic.performance.perfbase import PerfBase
    from openap import prop

    navdatabase.Navdatabase = NoNavigationData
    tools.init = lambda: None  # it reads the magnetic variation, which BlueSky reads again where it is needed
    prop.available_aircraft = lambda use_synonym=False: [TYPE.lower()]  # reading those of all types takes seconds
    bluesky.init(mode="sim", detached=True, workdir=Path.cwd())
    loaded = PerfBase.selected().__name__
    return "" if loaded == "OpenAP" else f"BlueSky has loaded the performance model {loaded}, not OpenAP"


def commanded(*lines: str) -> None:
    """Execute commands of BlueSky; one that is refused would leave an encounter other than described."""
    for line in lines:
        name, _, arguments = line.partition(" ")
        accepted, answer = Command.cmddict[name](arguments)
        if not accepted:
            raise Failed(f"BlueSky refuses the command {line}: {answer}")


def placed(p: Mapping[str, float]) -> None:
    """Both aircraft on straight tracks, on the equator, the second one so that they meet after MEETS seconds."""
    traffic = bluesky.traf
    course = math.radians(p["crossing_angle"])
    for name, heading, speed in zip(NAMES, (0.0, p["crossing_angle"]), (p["speed_own"], p["speed_other"]), strict=True):
        traffic.cre(name, TYPE, 0.0, 0.0, heading % 360.0, ALTITUDE, speed)
    own, other = traffic.tas.tolist()
    east = p["offset"] - other * MEETS * math.sin(course)
    north = own * MEETS - other * MEETS * math.cos(course)
    traffic.lon[1], traffic.lat[1] = math.degrees(east / RADIUS), math.degrees(north / RADIUS)


def apart() -> tuple[float, float]:
    """The second aircraft as seen from the first, east and north [m]."""
    lat, lon = np.radians(bluesky.traf.lat).tolist(), np.radians(bluesky.traf.lon).tolist()
    return RADIUS * (lon[1] - lon[0]) * math.cos(0.5 * (lat[0] + lat[1])), RADIUS * (lat[1] - lat[0])


def recorded(here: tuple[float, float]) -> dict[str, float]:
    """A row of the trace: both positions from the start of the first aircraft, and their distance."""
    lat, lon = np.radians(bluesky.traf.lat[0]).item(), np.radians(bluesky.traf.lon[0]).item()
    east, north = RADIUS * lon * math.cos(0.5 * lat), RADIUS * lat
    return {
        "time": float(bluesky.sim.simt),
        "east": east,
        "north": north,
        "other_east": east + here[0],
        "other_north": north + here[1],
        "distance": math.hypot(*here),
    }


def nearest(a: tuple[float, float], b: tuple[float, float]) -> float:
    """The least distance from the origin to the segment between two relative positions."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    along = -(a[0] * dx + a[1] * dy) / (dx * dx + dy * dy) if dx or dy else 0.0
    s = min(max(along, 0.0), 1.0)
    return math.hypot(a[0] + s * dx, a[1] + s * dy)


def separation(p: Mapping[str, float], trace: list[dict[str, float]] | None = None) -> dict[str, float]:
    """Simulate one encounter: the least horizontal distance, with straight motion between two steps.

    trace: the list to which its rows are appended.
    """
    bluesky.sim.reset()
    commanded(f"DT {STEP}", "CDMETHOD STATEBASED", f"RESO {'MVP' if p['resolution'] >= 0.5 else 'OFF'}")
    commanded(f"DTLOOK {p['look_ahead']!r}", "ZONER 5")
    placed(p)
    commanded(*(f"BANK {name} {p['bank']!r}" for name in NAMES))
    bluesky.sim.op()
    here, lowest = apart(), math.inf
    if math.hypot(*here) < ZONE:
        raise Excluded(f"the aircraft start inside the protected zone of {ZONE:g} m")
    if trace is not None:
        trace.append(recorded(here))
    while bluesky.sim.simt < ENDS:
        bluesky.sim.step()
        if bluesky.traf.ntraf != len(NAMES):
            raise Failed(f"BlueSky deleted an aircraft at {bluesky.sim.simt:g} s")
        before, here = here, apart()
        if not all(map(math.isfinite, here)):
            raise Failed(f"a position is not finite at {bluesky.sim.simt:g} s")
        lowest = min(lowest, nearest(before, here))
        if trace is not None:
            trace.append(recorded(here))
    return {"separation": lowest}


def unsuitable() -> str:
    """Why this installation cannot be used; empty if it can."""
    for package, expected, name in (("bluesky-simulator", VERSION, "VERSION"), ("openap", OPENAP, "OPENAP")):
        try:
            installed = version(package)
        except PackageNotFoundError:
            return f"the package {package} is not installed; where Clearance is installed: {INSTALL}"
        if installed != expected:
            return (
                f"{package} {installed} is installed, and this example is written for {expected}: {INSTALL}, "
                f"or change {name} in {__file__}"
            )
    return ""


def answered(asked: dict[str, Any]) -> dict[str, Any]:
    """The answer to one request: results, why it does not count, or an error with its reason."""
    try:
        rows: list[dict[str, float]] | None = [] if asked.get("trace") else None
        answer: dict[str, Any] = {"results": separation(asked["parameters"], rows)}
        return answer | ({"trace": {name: [row[name] for row in rows] for name in rows[0]}} if rows else {})
    except Excluded as error:
        return {"excluded": str(error)}
    except Failed as error:
        return {"error": str(error)}


if __name__ == "__main__":
    wrong = unsuitable()
    with contextlib.redirect_stdout(sys.stderr):
        wrong = wrong or initialised()
    for line in sys.stdin:
        with contextlib.redirect_stdout(sys.stderr):
            asked = json.loads(line)
            answer = {"error": wrong} if wrong else answered(asked)
        print(json.dumps({"id": asked.get("id"), **answer}), flush=True)
