"""Descriptors of FMUs: what is read from the model, what the descriptor adds, one sentence for every mistake."""

from __future__ import annotations

import sys
import zipfile
from pathlib import Path
from typing import Any

import pytest

from tests.fmu import made
from worker.engine.systems.simulators.declared.described import BadDescriptor
from worker.engine.systems.simulators.declared.descriptor import listed, read, unusable
from worker.engine.systems.simulators.declared.fmu import DescribedFmu, identifier


@pytest.mark.parametrize("fmi", [2, 3])
def test_the_model_gives_units_limits_and_start_values(tmp_path: Path, fmi: int) -> None:
    entry = read(made.folder(tmp_path, fmi)).entry
    assert [(p.name, p.unit, p.low, p.default, p.high, p.text) for p in entry.parameters] == [
        ("mass", "kg", 0.5, 2.0, 10.0, "Mass of the load"),
        ("speed", "m/s", 1.0, 15.0, 40.0, "Speed of the throw"),
        ("throw_angle", "rad", 0.0, 1.0, 1.5, "Angle above the horizon"),
        ("trouble", "", 0.0, 0.0, 9.0, "What goes wrong, by number"),
    ]
    assert [(r.name, r.unit) for r in entry.results] == [
        ("separation", "m"), ("far", "m"), ("height", "m"), ("landing", "s"),
    ]  # fmt: skip


def test_without_a_list_every_parameter_that_is_not_set_may_vary(tmp_path: Path) -> None:
    described = read(made.folder(tmp_path, 3, described={"parameters": None, "set": {"trouble": 0.0, "drag": False}}))
    assert [p.name for p in described.entry.parameters] == ["mass", "speed", "throw_angle"]


def test_the_descriptor_overrides_limits_nominal_and_text(tmp_path: Path) -> None:
    stated = {"load": {"variable": "mass", "nominal": 3, "low": 2, "high": 4, "text": "Load", "unit": "kg"}}
    (only,) = read(made.folder(tmp_path, 2, described={"parameters": stated})).entry.parameters
    assert (only.name, only.low, only.default, only.high, only.text) == ("load", 2.0, 3.0, 4.0, "Load")


def test_times_come_from_the_default_experiment_unless_stated(tmp_path: Path) -> None:
    usual = read(made.folder(tmp_path / "a", 2))
    other = read(made.folder(tmp_path / "b", 2, described={"stop": 1.0, "step": 0.25}))
    assert isinstance(usual, DescribedFmu)
    assert isinstance(other, DescribedFmu)
    assert (usual.stop, usual.step, usual.steps) == (3.0, 0.01, 300)
    assert (other.stop, other.step, other.steps) == (1.0, 0.25, 4)


def result(**changed: Any) -> dict[str, Any]:
    return {"results": {"d": {"variable": "separation", "take": "minimum"} | changed}}


@pytest.mark.parametrize(
    ("described", "expected"),
    [
        ({"command": ["x"]}, "command: not together with fmu"),
        ({"fmu": "../model.fmu"}, "fmu: expected text of the form"),
        ({"fmu": "other.fmu"}, "fmu: there is no file other.fmu"),
        ({"stop": -1}, "stop: -1 s must be after the start of the model, 0 s"),
        ({"step": 0.7}, "step: 3 s are 4.28571 steps of 0.7 s; a whole number is expected"),
        ({"step": 1e-9}, "step: 3e+09 steps of 1e-09 s; at most 10000000"),
        ({"parameters": None}, "parameters: the model states no finite min and max, or no start value, of trouble;"),
        ({"parameters": {}}, "parameters: the model states no finite min and max, or no start value, of trouble;"),
        ({"parameters": {"trouble": {"low": 0}}}, "parameters.trouble: the model states no finite value for high"),
        ({"parameters": {"mess": {}}}, "parameters.mess: model.fmu has no variable mess; it has mass, speed, "),
        ({"parameters": {"x": {}}}, "parameters.x: x is one Real, causality output, variability continuous; one real"),
        ({"parameters": {"drag": {}}}, "parameters.drag: drag is one Boolean, causality parameter"),
        ({"parameters": {"mass": {"low": 3}}}, "parameters.mass: nominal 2 must be within [low 3, high 10]"),
        ({"parameters": {"mass": {"unit": "g"}}}, "parameters.mass.unit: the model states kg, not g"),
        ({"parameters": {"mass": {}, "m": {"variable": "mass"}}}, "parameters.m: mass already sets this variable"),
        ({"parameters": {"mass": {"hgih": 3}}}, "parameters.mass.hgih: unknown key; remove it or correct its spelling"),
        ({"set": {"mass": 1.0}}, "set.mass: it is a parameter of the simulator"),
        ({"set": {"mast": 1.0}}, "set.mast: model.fmu has no variable of this name"),
        ({"set": {"drag": 1}}, "set.drag: 1 is not a value of type Boolean"),
        ({"set": {"x": 1.0}}, "set.x: it is output"),
        (result(take="mean"), "results.d.take: expected 'minimum', 'maximum', 'final' or 'first_crossing'"),
        (result(take="first_crossing"), "results.d: first_crossing requires level"),
        (result(level=1.0), "results.d: level and direction belong to first_crossing, not to minimum"),
        (result(variable="dist"), "results.d.variable: model.fmu has no variable dist; its outputs are x, z, "),
        (result(variable="drag"), "results.d.variable: drag is Boolean; one real number is expected"),
        (result(unit="km"), "results.d.unit: the model states m, not km"),
        ({"results": {}}, "results: expected at least 1 entr"),
    ],
)  # fmt: skip
def test_a_mistake_is_named_with_its_key(tmp_path: Path, described: dict[str, Any], expected: str) -> None:
    refused(made.folder(tmp_path, 2, described=described), expected)


@pytest.mark.parametrize(
    ("changed", "expected"),
    [
        (
            {"platform": "win64"},
            "fmu: model.fmu has no binaries/linux64/thrown.so, the binary for this platform; it is",
        ),
        ({"kind": "ModelExchange"}, "fmu: model.fmu is not made for co-simulation; export it for co-simulation"),
        ({"files": {"../../evil": "x"}}, "fmu: model.fmu holds a file '../../evil', which is outside its folder"),
        ({"files": {"/evil": "x"}}, "fmu: model.fmu holds a file '/evil', which is outside its folder"),
        ({"files": {"a\\..\\evil": "x"}}, "fmu: model.fmu holds a file 'a\\\\..\\\\evil', which is outside"),
        ({"xml": "<fmiModelDescription fmiVersion='2.0'>"}, "fmu: model.fmu: "),
        ({"xml": "<a/>"}, "fmu: model.fmu: "),
        ({"xml": "<fmiModelDescription fmiVersion='9.0'/>"}, "fmu: model.fmu: Unsupported FMI version: 9.0"),
    ],
)
def test_an_fmu_that_cannot_run_here_is_refused(tmp_path: Path, changed: dict[str, Any], expected: str) -> None:
    refused(made.folder(tmp_path, 2, binary=b"never loaded", **changed), expected)


@pytest.mark.parametrize("content", [b"", b"no archive", None])
def test_what_is_no_fmu_is_refused(tmp_path: Path, content: bytes | None) -> None:
    folder = made.folder(tmp_path, 2, binary=b"never loaded")
    if content is not None:
        (folder / "model.fmu").write_bytes(content)
    else:
        with zipfile.ZipFile(folder / "model.fmu", "w") as archive:
            archive.writestr("readme", "")
    refused(folder, "fmu: model.fmu is not an FMU: ")


def test_an_alias_is_not_a_second_parameter(tmp_path: Path) -> None:
    """Setting both would leave the value of one of them without effect."""
    text = made.description(2)
    scalar = text[text.index('<ScalarVariable name="mass"') :].partition("</ScalarVariable>")[0] + "</ScalarVariable>"
    second = scalar.replace('name="mass"', 'name="weight"')
    changed = {"xml": text.replace("</ModelVariables>", f"{second}</ModelVariables>"), "binary": b"never loaded"}
    both = {"parameters": {"mass": {}, "weight": {"nominal": 2.0}}}
    refused(
        made.folder(tmp_path / "a", 2, described=both, **changed), "parameters.weight: mass already sets this variable"
    )
    fixed = {"parameters": {"mass": {}}, "set": {"weight": 3.0}}
    refused(
        made.folder(tmp_path / "b", 2, described=fixed, **changed), "set.weight: it is a parameter of the simulator"
    )


def test_without_fmpy_a_sentence_names_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "fmpy", None)
    refused(made.folder(tmp_path, 2, binary=b"never loaded"), "fmu: an FMU requires the package FMPy")


def test_a_bad_one_is_listed_with_its_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made.folder(tmp_path / "a", 2, binary=b"never loaded", kind="ModelExchange")
    made.folder(tmp_path / "b", 2, binary=b"never loaded")
    monkeypatch.setenv("CLEARANCE_SIMULATORS", str(tmp_path))
    assert [isinstance(found, BadDescriptor) for found in listed()] == [True, False]
    assert len(unusable()) == 1


def test_the_digest_changes_with_the_file(tmp_path: Path) -> None:
    folder = made.folder(tmp_path, 2, binary=b"never loaded")
    before = read(folder).digest
    made.fmu(folder / "model.fmu", 2, binary=b"another one")
    assert read(folder).digest != before


@pytest.mark.parametrize(
    ("name", "expected"), [("Body.m[1]", "body_m_1"), ("1st", "p_1st"), ("der(x)", "der_x"), ("ä", "p_")]
)
def test_variables_have_names_that_a_campaign_can_state(name: str, expected: str) -> None:
    assert identifier(name) == expected


def refused(folder: Path, expected: str) -> None:
    with pytest.raises(BadDescriptor) as caught:
        read(folder)
    message = str(caught.value)
    assert message.startswith(f"{folder / 'simulator.yaml'}: {expected}")
    assert "\n" not in message
    assert len(message) < 800
