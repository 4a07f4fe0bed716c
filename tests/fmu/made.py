"""Builds FMUs from `thrown.c`, and folders with descriptors of them."""

from __future__ import annotations

import platform
import shutil
import subprocess
import zipfile
from functools import cache
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

import pytest
import yaml

SOURCE = Path(__file__).with_name("thrown.c")
EXAMPLE = Path(__file__).parents[2] / "docs" / "examples" / "fmu_drop"
TOKEN = "{8c4e810f-3df3-4a00-8276-176fa3c9f000}"
MACHINE = platform.machine()

PARAMETERS = (
    ("mass", 1, "parameter", "tunable", 'unit="kg" min="0.5" max="10" start="2"', "Mass of the load"),
    ("speed", 2, "parameter", "fixed", 'unit="m/s" min="1" max="40" start="15"', "Speed of the throw"),
    ("throw.angle", 3, "input", "continuous", 'unit="rad" min="0" max="1.5" start="1"', "Angle above the horizon"),
    ("trouble", 4, "parameter", "fixed", 'start="0"', "What goes wrong, by number"),
)
OUTPUTS = (("x", 10, "m"), ("z", 11, "m"), ("separation", 12, "m"))

RESULTS: dict[str, dict[str, Any]] = {
    "separation": {"variable": "separation", "take": "minimum"},
    "far": {"variable": "x", "take": "final"},
    "height": {"variable": "z", "take": "maximum"},
    "landing": {"variable": "z", "take": "first_crossing", "level": 0.0, "direction": "falling"},
}
VARIED = {"mass": {}, "speed": {}, "throw_angle": {}, "trouble": {"low": 0, "high": 9}}


@cache
def compiled(fmi: int, leak: int = 0, token: str = TOKEN, starts: str = "") -> bytes:
    """The shared library; starts: a command that it runs when it is first instantiated."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        pytest.skip("no C compiler")
    binary = Path(mkdtemp()) / "thrown.so"
    options = [
        f"-DFMI={fmi}",
        f"-DLEAK={leak}",
        *(["-DNORESET"] if leak == 3 else []),
        f'-DTOKEN="{token}"',
        *([f'-DSTARTS="{starts}"'] if starts else []),
        "-w",
        "-O2",
        "-shared",
        "-fPIC",
    ]
    subprocess.run([compiler, *options, "-o", binary, SOURCE, "-lm"], check=True)
    content = binary.read_bytes()
    shutil.rmtree(binary.parent)
    return content


def description(fmi: int, kind: str = "CoSimulation") -> str:
    """modelDescription.xml."""
    return _of_fmi2(kind) if fmi == 2 else _of_fmi3(kind)


def _of_fmi2(kind: str) -> str:
    scalars = [
        f'<ScalarVariable name="{name}" valueReference="{reference}" causality="{causality}"'
        f' variability="{variability}" description="{text}"><Real {rest}/></ScalarVariable>'
        for name, reference, causality, variability, rest, text in PARAMETERS
    ]
    scalars += [
        f'<ScalarVariable name="{name}" valueReference="{reference}" causality="output">'
        f'<Real unit="{unit}"/></ScalarVariable>'
        for name, reference, unit in OUTPUTS
    ]
    scalars += [
        '<ScalarVariable name="drag" valueReference="20" causality="parameter" variability="fixed">'
        '<Boolean start="true"/></ScalarVariable>'
    ]
    outputs = "".join(f'<Unknown index="{k}"/>' for k in (5, 6, 7))
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="thrown" guid="{TOKEN}" description="A mass thrown past a mast">
<{kind} modelIdentifier="thrown" {"canHandleVariableCommunicationStepSize='true'" if kind == "CoSimulation" else ""}/>
<UnitDefinitions>{"".join(f'<Unit name="{u}"/>' for u in ("kg", "m", "m/s", "rad"))}</UnitDefinitions>
<LogCategories><Category name="logStatusError"/></LogCategories>
<DefaultExperiment startTime="0" stopTime="3" stepSize="0.01"/>
<ModelVariables>{"".join(scalars)}</ModelVariables>
<ModelStructure><Outputs>{outputs}</Outputs><InitialUnknowns>{outputs}</InitialUnknowns></ModelStructure>
</fmiModelDescription>"""


def _of_fmi3(kind: str) -> str:
    variables = [
        f'<Float64 name="{name}" valueReference="{reference}" causality="{causality}" variability="{variability}"'
        f' {rest} description="{text}"/>'
        for name, reference, causality, variability, rest, text in PARAMETERS
    ]
    variables += [
        f'<Float64 name="{name}" valueReference="{reference}" causality="output" unit="{unit}"/>'
        for name, reference, unit in OUTPUTS
    ]
    variables.append('<Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>')
    variables.append(
        '<Float64 name="gains" valueReference="30" causality="parameter" start="1 2"><Dimension start="2"/></Float64>'
    )
    variables.append('<Boolean name="drag" valueReference="20" causality="parameter" start="true"/>')
    outputs = "".join(f'<Output valueReference="{reference}"/>' for _, reference, _ in OUTPUTS)
    unknown = "".join(f'<InitialUnknown valueReference="{reference}"/>' for _, reference, _ in OUTPUTS)
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="thrown" instantiationToken="{TOKEN}">
<{kind} modelIdentifier="thrown"/>
<UnitDefinitions>{"".join(f'<Unit name="{u}"/>' for u in ("kg", "m", "m/s", "rad"))}</UnitDefinitions>
<LogCategories><Category name="logStatusError"/></LogCategories>
<DefaultExperiment startTime="0" stopTime="3" stepSize="0.01"/>
<ModelVariables>{"".join(variables)}</ModelVariables>
<ModelStructure>{outputs}{unknown}</ModelStructure>
</fmiModelDescription>"""


def fmu(file: Path, fmi: int, leak: int = 0, **changed: Any) -> Path:
    """An FMU; changed: token of the binary, kind of FMU, platform, further files, text of modelDescription.xml."""
    usual = "linux64" if fmi == 2 else f"{MACHINE}-linux"
    with zipfile.ZipFile(file, "w") as archive:
        text = changed.get("xml") or description(fmi, changed.get("kind", "CoSimulation"))
        archive.writestr("modelDescription.xml", text)
        binary = changed.get("binary") or compiled(fmi, leak, changed.get("token", TOKEN))
        archive.writestr(f"binaries/{changed.get('platform', usual)}/thrown.so", binary)
        for name, content in changed.get("files", {}).items():
            archive.writestr(name, content)
    return file


def folder(at: Path, fmi: int, leak: int = 0, described: dict[str, Any] | None = None, **changed: Any) -> Path:
    """A folder with an FMU and its descriptor; described: keys that differ, None to leave one out."""
    at.mkdir(parents=True, exist_ok=True)
    fmu(at / "model.fmu", fmi, leak, **changed)
    document = {
        "name": "thrown",
        "fmu": "model.fmu",
        "parameters": VARIED,
        "results": RESULTS,
        "timeout": 2,
        "slots": 1,
    }
    document = {k: v for k, v in (document | (described or {})).items() if v is not None}
    (at / "simulator.yaml").write_text(yaml.safe_dump(document, sort_keys=False), encoding="utf-8")
    return at


def example(at: Path) -> Path:
    """The folder of docs/examples/fmu_drop, built from its sources."""
    if shutil.which("cc") is None:
        pytest.skip("no C compiler")
    folder = shutil.copytree(EXAMPLE, at / "fmu_drop")
    subprocess.run(["sh", str(folder / "build.sh")], check=True)
    return folder
