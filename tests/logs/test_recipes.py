"""The adapters of docs/examples with programs that stand for PX4 and ROS 2: what they call, read and refuse."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.faults.processes import REPOSITORY
from tests.logs.written import ODOMETRY, mcap, ulog
from worker.engine.systems.simulators.declared.descriptor import read
from worker.engine.systems.simulators.slots.slot import guarded

EXAMPLES = REPOSITORY / "docs" / "examples"
FLIGHT = [(0.2 * k, 0.5 * k, 0.0, -5.0) for k in range(121)]
DRIVE = [(0.1 * k, 0.05 * k, 0.0, 0.0) for k in range(81)]


def program(file: Path, text: str) -> Path:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(f"#!/bin/sh\n{text}\n")
    file.chmod(0o755)
    return file


def called(folder: Path, script: str, *arguments: str, parameters: dict[str, float], **environment: Any) -> Any:
    """The results that the script writes, or the end of its output."""
    (folder / "parameters.json").write_text(json.dumps(parameters))
    files = [str(folder / name) for name in ("parameters.json", "results.json")]
    done = subprocess.run(
        [*guarded(-1), sys.executable, str(EXAMPLES / script), *arguments, *files],
        env=os.environ | {"PYTHONPATH": str(REPOSITORY), **{k: str(v) for k, v in environment.items()}},
        capture_output=True, text=True, check=False, timeout=60,
    )  # fmt: skip
    written = folder / "results.json"
    assert written.exists() == (done.returncode == 0)
    return json.loads(written.read_text()) if written.exists() else done.stderr


@pytest.mark.parametrize("name", ["px4_sitl", "nav2"])
def test_the_descriptors_are_usable(name: str) -> None:
    assert read(EXAMPLES / name).entry.name == name


def px4(tmp_path: Path, log: Path | None, mission: str = "exit 0") -> dict[str, Path]:
    copy = f"mkdir -p log/today; cp {log} log/today/a.ulg" if log else "true"
    text = f'echo "$@" > {tmp_path}/called; env | grep ^PX4_ > {tmp_path}/environment; {copy}; touch {tmp_path}/up'
    build = program(tmp_path / "build" / "bin" / "px4", f"{text}; exec sleep 30").parents[1]
    wait = f"while [ ! -e {tmp_path}/up ]; do :; done; echo $1 > {tmp_path}/port; {mission}"
    return {"PX4_BUILD": build, "PX4_MISSION": program(tmp_path / "mission", wait)}


@pytest.mark.nightly
def test_px4_is_started_for_the_slot_with_its_parameters(tmp_path: Path) -> None:
    log = ulog(tmp_path / "a.ulg", {"vehicle_local_position_groundtruth": FLIGHT})
    wind = {"wind_n": 2.5, "wind_e": -1.0}
    found = called(tmp_path, "px4_sitl/fly.py", "3", parameters=wind, **px4(tmp_path, log))
    assert found == {"separation": pytest.approx(3.0, abs=1e-6)}
    assert (tmp_path / "called").read_text().split() == ["-i", "3", "-d", str(tmp_path / "build" / "etc")]
    assert (tmp_path / "port").read_text() == "14543\n"
    lines = (tmp_path / "environment").read_text().splitlines()
    assert {"PX4_PARAM_SIH_WIND_N=2.5", "PX4_PARAM_SIH_WIND_E=-1.0", "PX4_SIM_MODEL=sihsim_quadx"} <= {*lines}


@pytest.mark.nightly
def test_a_flight_that_was_not_one_has_no_result(tmp_path: Path) -> None:
    short = ulog(tmp_path / "a.ulg", {"vehicle_local_position_groundtruth": FLIGHT[:50]})
    cases = (
        (short, "exit 0", "ends after 9.800 s; at least 20 s are expected"),
        (None, "exit 0", "one log is expected, PX4 wrote 0"),
        (short, "exit 4", "returned non-zero exit status 4"),
    )
    for k, (log, mission, expected) in enumerate(cases):
        folder = tmp_path / str(k)
        folder.mkdir()
        found = called(folder, "px4_sitl/fly.py", "0", parameters={"wind_n": 0.0}, **px4(folder, log, mission))
        assert expected in found


@pytest.mark.nightly
def test_nav2_is_launched_recorded_and_read(tmp_path: Path) -> None:
    bag = mcap(tmp_path / "whole.mcap", {"/odom": (ODOMETRY, "odom", DRIVE)})
    record = f'while [ "$1" != -o ]; do shift; done; mkdir "$2"; cp {bag} "$2"; touch {tmp_path}/up'
    program(
        tmp_path / "bin" / "ros2", f'echo "$@" >> {tmp_path}/called\n[ $1 = launch ] || {{ {record}; }}\nexec sleep 30'
    )
    goal = program(tmp_path / "goal", f"while [ ! -e {tmp_path}/up ]; do :; done")
    path = f"{tmp_path / 'bin'}:{os.environ['PATH']}"
    start = {"x_pose": -2.0, "y_pose": -0.5}
    assert called(tmp_path, "nav2/drive.py", parameters=start, NAV2_GOAL=goal, PATH=path) == {
        "separation": pytest.approx(0.35, abs=1e-6)
    }
    lines = sorted((tmp_path / "called").read_text().splitlines())
    assert lines[0].split()[:5] == ["bag", "record", "-s", "mcap", "-o"]
    assert lines[1].endswith("tb3_simulation_launch.py headless:=True use_rviz:=False x_pose:=-2.0 y_pose:=-0.5")
