"""Drives a TurtleBot 3 with Nav2 once and measures the separation in a recording: drive.py PARAMETERS RESULTS.

Set in the environment of the worker, besides that of ROS 2: NAV2_GOAL, a program of yours that waits for Nav2, sends
the goal, and returns 0 when the robot has arrived.
"""

import contextlib
import json
import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

from worker.engine.systems.simulators.logs.approach import Column
from worker.engine.systems.simulators.logs.rosbag import separation_of_mcap

TOPIC = "/odom"
OBSTACLES = [Column(x=2.0, y=0.5, radius=0.15)]
"""In the frame of the odometry [m]; those of your world."""
SHORTEST = 5.0
"""A drive that lasts less did not reach its goal [s]."""


def launched(parameters: dict[str, float]) -> list[str]:
    """The command that starts simulator, robot and Nav2."""
    start = [f"{name}:={value!r}" for name, value in parameters.items()]
    return ["ros2", "launch", "nav2_bringup", "tb3_simulation_launch.py", "headless:=True", "use_rviz:=False", *start]


def recorded(folder: Path) -> list[str]:
    return ["ros2", "bag", "record", "-s", "mcap", "-o", str(folder), TOPIC]


def drive(parameters: dict[str, float], folder: Path) -> None:
    """Record one drive into a folder that does not exist yet."""
    with contextlib.ExitStack() as running:
        for command in (launched(parameters), recorded(folder)):
            running.callback(stop, subprocess.Popen(command, stdin=subprocess.DEVNULL, start_new_session=True))
        subprocess.run([os.environ["NAV2_GOAL"]], check=True)


def stop(process: subprocess.Popen) -> None:
    """Ask it and what it started to end, so that the recording is complete; then make sure of it."""
    for sign, seconds in ((signal.SIGINT, 20), (signal.SIGKILL, None)):
        try:
            os.killpg(process.pid, sign)
            process.wait(seconds)
        except ProcessLookupError:
            return
        except subprocess.TimeoutExpired:
            continue


def main() -> None:
    given, written = Path(sys.argv[1]), Path(sys.argv[2])
    with tempfile.TemporaryDirectory(dir=given.parent) as work:
        folder = Path(work) / "recording"
        drive(json.loads(given.read_text()), folder)
        try:
            found = separation_of_mcap(folder, TOPIC, obstacles=OBSTACLES, lasts=SHORTEST)
        except ValueError as error:
            sys.exit(str(error))
    written.write_text(json.dumps({"separation": found.d_min}))


if __name__ == "__main__":
    main()
