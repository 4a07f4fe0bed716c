"""JSBSim and BlueSky as simulators of docs/examples: they repeat to the bit, and what they compute is plausible."""

from __future__ import annotations

import json
import runpy
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from campaigns.results.base import EXCLUDED, FAILED, OK
from tests.faults.launched import run
from tests.faults.processes import REPOSITORY
from worker.engine.systems.simulators.command import CommandSimulator
from worker.engine.systems.simulators.declared.descriptor import read
from worker.engine.systems.simulators.declared.simulator import Opening

EXAMPLES = REPOSITORY / "docs" / "examples"
needs_jsbsim = pytest.mark.skipif(find_spec("jsbsim") is None, reason="the package jsbsim is not installed")
needs_bluesky = pytest.mark.skipif(
    find_spec("bluesky") is None,
    reason="the package bluesky-simulator, which is not in the lock file, is not installed",
)


def opened(folder: Path) -> CommandSimulator:
    """The simulator in one slot, because a process takes seconds to start."""
    described = read(folder)
    described = replace(described, descriptor=described.descriptor.model_copy(update={"slots": 1}))
    nominal = {f"simulator.{name}": p.nominal for name, p in described.descriptor.parameters.items()}
    return CommandSimulator(described, Opening(nominal, "separation"))


def separations(simulator: CommandSimulator, *cases: dict[str, float]) -> np.ndarray:
    """The separation of each case, which differs from nominal by these parameters."""
    vectors = np.tile(simulator.nominal, (len(cases), 1))
    for row, case in zip(vectors, cases, strict=True):
        for name, value in case.items():
            row[simulator.names[f"simulator.{name}"]] = value
    batch, reasons = simulator.evaluate(vectors)
    assert reasons == {}
    assert (batch.status == OK).all()
    return batch.costs[:, 0]


@pytest.fixture(scope="module")
def jsbsim() -> Iterator[CommandSimulator]:
    simulator = opened(EXAMPLES / "jsbsim_intruder")
    yield simulator
    simulator.close()


@needs_jsbsim
def test_jsbsim_avoids_and_errors_of_the_sensor_cost_separation(jsbsim: CommandSimulator) -> None:
    avoided, not_avoided, biased = separations(jsbsim, {}, {"clearance": 0.0}, {"bearing_bias": 5.0})
    assert not_avoided < 50.0
    assert avoided > 140.0
    assert not_avoided < biased < avoided


@needs_jsbsim
def test_jsbsim_without_avoidance_passes_at_the_offset(jsbsim: CommandSimulator) -> None:
    """A closed form but for the drift of the autopilot: the separation of two straight tracks is the offset's part
    across the relative velocity, all of it head-on."""
    found = separations(jsbsim, {"clearance": 0.0, "offset": 500.0}, {"clearance": 0.0, "offset": -500.0})
    assert found == pytest.approx([500.0, 500.0], abs=60.0)


@needs_jsbsim
@pytest.mark.parametrize("changed", [{"payload": 200.0}, {"wind_north": 10.0}, {"wind_east": -10.0}])
def test_every_parameter_of_the_flight_reaches_jsbsim(jsbsim: CommandSimulator, changed: dict[str, float]) -> None:
    """JSBSim ignores what is written to a read-only property, and its trim resets the wind."""
    nominal, other = separations(jsbsim, {}, changed)
    assert nominal != other


@needs_jsbsim
def test_jsbsim_repeats_to_the_bit_in_any_order_and_process(jsbsim: CommandSimulator) -> None:
    cases: list[dict[str, float]] = [{"wind_north": 7.0, "intruder_angle": 120.0}, {}, {"payload": 0.0}]
    first = separations(jsbsim, *cases)
    backwards = separations(jsbsim, *reversed(cases))[::-1]
    fresh = jsbsim.fresh()
    try:
        again = separations(fresh, cases[0])
    finally:
        fresh.close()
    assert first.tolist() == backwards.tolist()
    assert again[0] == first[0]


@needs_jsbsim
def test_jsbsim_shows_the_encounter_that_it_evaluated(jsbsim: CommandSimulator) -> None:
    """The result that comes with a trace is compared to the bit by `trace`; its closest row is near it."""
    (value,) = separations(jsbsim, {"intruder_angle": 120.0})
    found = jsbsim.trace("F1", {"simulator.intruder_angle": 120.0})
    assert found is not None
    assert found.meta.cost == value
    assert found.meta.scene is not None
    at = {column.name: found.data[:, k] for k, column in enumerate(found.columns)}
    assert at["time"] == pytest.approx(np.linspace(0.0, 50.0, 501))
    apart = [at[f"intruder_{axis}"] - at[axis] for axis in ("north", "east", "down")]
    assert np.linalg.norm(apart, axis=0) == pytest.approx(at["distance"])
    assert value <= at["distance"].min() < value + 2.0
    course = np.degrees(np.arctan2(np.diff(at["east"]), np.diff(at["north"])))
    assert at["heading"][1:] == pytest.approx(course, abs=3.0), "it flies where it points, but for side slip"
    assert -at["down"] == pytest.approx(1219.0, abs=30.0)


@pytest.mark.nightly
@needs_jsbsim
def test_jsbsim_writes_no_files(tmp_path: Path) -> None:
    """c172x asks JSBSim for a table of its flight in the working folder."""
    program = EXAMPLES / "jsbsim_intruder" / "jsbsim_flight.py"
    parameters = {n: p.nominal for n, p in read(program.parent).descriptor.parameters.items()}
    given = json.dumps({"parameters": parameters})
    subprocess.run([sys.executable, str(program)], input=given, text=True, check=True, cwd=tmp_path, timeout=60)
    assert list(tmp_path.iterdir()) == []


@needs_jsbsim
def test_a_start_that_is_no_encounter_is_excluded_with_a_sentence(jsbsim: CommandSimulator) -> None:
    vector = jsbsim.nominal.copy()
    vector[jsbsim.names["simulator.intruder_angle"]] = 0.0
    batch, reasons = jsbsim.evaluate(vector[None, :])
    assert batch.status.tolist() == [EXCLUDED]
    assert " 500 m" in reasons[0]


@pytest.mark.parametrize(
    ("name", "file", "stated"),
    [
        ("jsbsim_intruder", "jsbsim_flight.py", "VERSION"),
        ("bluesky_mvp", "bluesky_conflict.py", "VERSION"),
        ("bluesky_mvp", "bluesky_conflict.py", "OPENAP"),
    ],
)
def test_another_version_of_the_package_is_refused_with_a_sentence(
    tmp_path: Path, name: str, file: str, stated: str
) -> None:
    """The version is part of the folder, so of the digest, so of what a verdict holds for."""
    if find_spec({"jsbsim_intruder": "jsbsim", "bluesky_mvp": "bluesky"}[name]) is None:
        pytest.skip(f"the package of {name} is not installed")
    folder = shutil.copytree(EXAMPLES / name, tmp_path / name)
    text = (folder / file).read_text()
    lines = [f'{stated} = "0.0"' if line.startswith(f"{stated} = ") else line for line in text.splitlines()]
    (folder / file).write_text("\n".join(lines))
    simulator = opened(folder)
    try:
        batch, reasons = simulator.evaluate(simulator.nominal[None, :])
    finally:
        simulator.close()
    assert batch.status.tolist() == [FAILED]
    assert " 0.0: pip install 'clearance[" in reasons[0]


@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    ("package", "program"),
    [("jsbsim", "jsbsim_intruder/jsbsim_flight.py"), ("bluesky", "bluesky_mvp/bluesky_conflict.py")],
)
def test_without_the_package_the_command_that_installs_it_is_stated(
    monkeypatch: pytest.MonkeyPatch, package: str, program: str
) -> None:
    monkeypatch.setitem(sys.modules, package, None)  # as if it were not there
    with pytest.raises(SystemExit) as ended:
        runpy.run_path(str(EXAMPLES / program), run_name="__main__")
    assert f"the package {package} is not installed; " in str(ended.value)
    assert f"pip install 'clearance[{package}]'" in str(ended.value)


@pytest.mark.nightly
@needs_bluesky
def test_bluesky_resolves_the_conflict_repeats_and_leaves_no_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In any order and process. Its files are in the folder of the slot, which is removed."""
    monkeypatch.setenv("HOME", str(tmp_path))
    simulator = opened(EXAMPLES / "bluesky_mvp")
    fresh = simulator.fresh()
    crossing = {"crossing_angle": 60.0, "offset": 2000.0}
    try:
        resolved, conflict, again = separations(simulator, crossing, {**crossing, "resolution": 0.0}, crossing)
        alone = separations(fresh, crossing)
        shown = simulator.trace("F1", {f"simulator.{name}": value for name, value in crossing.items()})
    finally:
        simulator.close()
        fresh.close()
    assert conflict < 2000.0
    assert resolved > 9000.0
    assert resolved == again == alone[0]
    assert shown is not None
    assert shown.meta.cost == resolved
    assert shown.meta.scene is not None
    distance = shown.data[:, [column.name for column in shown.columns].index("distance")]
    assert resolved <= distance.min() < resolved + 50.0
    assert list(tmp_path.iterdir()) == []


@pytest.mark.nightly
@needs_jsbsim
@pytest.mark.timeout(1800)
def test_the_campaign_of_jsbsim_finds_a_violation() -> None:
    code, result, errors = run(EXAMPLES, EXAMPLES / "campaigns" / "jsbsim_intruder.yaml", timeout=1700)
    assert code == 1, errors
    assert result["verdict"] == "violated"


@pytest.mark.nightly
@needs_bluesky
@pytest.mark.timeout(3600)
def test_the_campaign_of_bluesky_finds_a_violation() -> None:
    code, result, errors = run(EXAMPLES, EXAMPLES / "campaigns" / "bluesky_mvp.yaml", timeout=3500)
    assert code == 1, errors
    assert result["verdict"] == "violated"
