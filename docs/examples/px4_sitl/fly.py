"""Flies PX4 in SITL once and measures the separation in its log: fly.py SLOT PARAMETERS RESULTS.

Set in the environment of the worker: PX4_BUILD, the folder build/px4_sitl_default; PX4_MISSION, a program of yours that
is called with the MAVLink port of this vehicle, flies it, lands it, and returns 0 when it is disarmed.
"""

import json
import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

from worker.engine.systems.simulators.logs.approach import Column
from worker.engine.systems.simulators.logs.ulog import separation_of_ulog

PARAMETERS = {"wind_n": "SIH_WIND_N", "wind_e": "SIH_WIND_E"}
"""The parameter of PX4 for each of ours."""
OBSTACLES = [Column(x=30.0, y=4.0, radius=1.0)]
"""In the local frame of the log: north and east of the place where the estimator started [m]."""
TOPIC = "vehicle_local_position_groundtruth"
"""Where the simulated vehicle is; `vehicle_local_position` is where its estimator believes it is."""
SHORTEST = 20.0
"""A flight that lasts less did not do its mission [s]."""


def environment(parameters: dict[str, float]) -> dict[str, str]:
    """The environment of PX4: the vehicle, no window, and a variable for each parameter."""
    given = {f"PX4_PARAM_{PARAMETERS[name]}": repr(value) for name, value in parameters.items()}
    return {"PX4_SIMULATOR": "sihsim", "PX4_SIM_MODEL": "sihsim_quadx", "HEADLESS": "1", **given}


def fly(slot: int, parameters: dict[str, float], folder: Path) -> Path:
    """The log of one flight, in an empty folder, so that no parameter of an earlier flight is left."""
    build = Path(os.environ["PX4_BUILD"])
    px4 = subprocess.Popen(
        [build / "bin" / "px4", "-i", str(slot), "-d", build / "etc"],
        cwd=folder, env=os.environ | environment(parameters), stdin=subprocess.DEVNULL, start_new_session=True,
    )  # fmt: skip
    try:
        subprocess.run([os.environ["PX4_MISSION"], str(14540 + slot)], check=True)
    finally:
        stop(px4)
    logs = sorted(folder.rglob("*.ulg"))
    if len(logs) != 1:
        sys.exit(f"one log is expected, PX4 wrote {len(logs)}")
    return logs[0]


def stop(process: subprocess.Popen) -> None:
    """Ask it to end, so that its log is complete; then make sure of it."""
    process.send_signal(signal.SIGINT)
    try:
        process.wait(10)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def main() -> None:
    slot, given, written = int(sys.argv[1]), Path(sys.argv[2]), Path(sys.argv[3])
    with tempfile.TemporaryDirectory(dir=given.parent) as folder:
        log = fly(slot, json.loads(given.read_text()), Path(folder))
        try:
            found = separation_of_ulog(log, OBSTACLES, topic=TOPIC, lasts=SHORTEST)
        except ValueError as error:
            sys.exit(f"{log.name}: {error}")
    written.write_text(json.dumps({"separation": found.d_min}))


if __name__ == "__main__":
    main()
