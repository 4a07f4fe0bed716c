"""`clearance examples`: whoever installed a package has every file that docs/your-own-simulator.md names."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

from campaigns.refusals import RefusalCode
from clearance.cli import WRONG_INPUT, invoke
from clearance.cli.examples import KINDS, WHERE, shipped
from tests.given.refused_commands import fields, refused
from worker.running.catalogue.installed import forget_simulators

REPOSITORY = Path(__file__).parents[4]
GUIDE = (REPOSITORY / "docs" / "your-own-simulator.md").read_text(encoding="utf-8")
RUNS = "CLEARANCE_SIMULATORS=docs/examples clearance run docs/examples/campaigns/"
CAMPAIGNS = ["drop", "fmu_drop", "jsbsim_intruder", "bluesky_mvp"]
BUILT = {
    "drop": "cc -O2 -o docs/examples/drop/drop docs/examples/drop/drop.c -lm",
    "fmu_drop": "sh docs/examples/fmu_drop/build.sh",
}


def tracked() -> set[Path]:
    """The files of the examples in the repository, without what was built there."""
    folder = REPOSITORY / WHERE
    return {f.relative_to(folder) for f in folder.rglob("*") if f.suffix in KINDS and f.is_file()}


@pytest.fixture
def empty(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """An empty folder, in which the simulators of docs/examples are searched."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("CLEARANCE_SIMULATORS", str(WHERE))
    forget_simulators()
    yield tmp_path
    forget_simulators()


def test_they_are_copied_where_the_guides_name_them(empty: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["examples"]) == 0
    assert f"export CLEARANCE_SIMULATORS={WHERE.absolute()}\n" in capsys.readouterr().out
    assert {f.relative_to(WHERE) for f in WHERE.rglob("*") if f.is_file()} == tracked()
    pages = [REPOSITORY / "README.md", *(REPOSITORY / "docs").glob("*.md")]
    named = {n.rstrip("./") for page in pages for n in re.findall(r"docs/examples/[\w./-]+", page.read_text("utf-8"))}
    assert {name for name in named - {"docs/examples/drop/drop"} if not Path(name).exists()} == set()


def test_nothing_is_overwritten(empty: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (empty / "mine").mkdir()
    assert refused(capsys, "examples", "mine") == RefusalCode.EXISTS
    assert list((empty / "mine").iterdir()) == []


def test_a_package_contains_each_of_them() -> None:
    stated = tomllib.loads((REPOSITORY / "pyproject.toml").read_text("utf-8"))["tool"]["setuptools"]["data-files"]
    packed = {
        Path(target).relative_to("share/clearance/examples") / file.name
        for target, patterns in stated.items()
        if target.startswith("share/clearance/examples")
        for pattern in patterns
        for file in REPOSITORY.glob(pattern)
    }
    assert packed == tracked() == set(shipped())


def test_the_extras_are_the_versions_for_which_the_examples_are_written() -> None:
    """Another version is refused by the example, so an extra that allows one leads to a failed run."""
    extras = tomllib.loads((REPOSITORY / "pyproject.toml").read_text("utf-8"))["project"]["optional-dependencies"]
    for extra, folder in {"jsbsim": "jsbsim_intruder", "bluesky": "bluesky_mvp"}.items():
        text = "".join(f.read_text("utf-8") for f in (REPOSITORY / WHERE / folder).glob("*.py"))
        for requirement in extras[extra]:
            _, version = requirement.split(" ;")[0].split("==")
            assert f'"{version}"' in text, requirement


@pytest.mark.by_day(1)
@pytest.mark.parametrize("name", CAMPAIGNS)
def test_the_guide_has_one_command_for_each_and_its_campaign_is_usable(empty: Path, name: str) -> None:
    """To the verdict: below, and tests/faults/test_real_simulators.py, by night."""
    assert [line for line in GUIDE.splitlines() if line.startswith(f"{RUNS}{name}.yaml")]
    assert invoke(["examples"]) == 0
    build(name)
    assert invoke(["validate", f"docs/examples/campaigns/{name}.yaml"]) == 0


def build(name: str) -> None:
    """What the guide says to type before."""
    if name in BUILT:
        if shutil.which("cc") is None:
            pytest.skip("no C compiler")
        assert BUILT[name] in GUIDE.splitlines()
        subprocess.run(BUILT[name], shell=True, check=True)


@pytest.mark.nightly
@pytest.mark.parametrize("name", BUILT)
def test_the_commands_of_the_guide_lead_to_the_verdict(empty: Path, name: str) -> None:
    assert invoke(["examples"]) == 0
    build(name)
    found = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    done = subprocess.run(
        f"{RUNS}{name}.yaml", shell=True, env=os.environ | {"PATH": found}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 1, done.stderr
    assert "✗ Violated" in done.stdout


@pytest.mark.parametrize("command", ["run", "validate"])
def test_without_simulators_the_message_states_where_they_are_named(
    empty: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], command: str
) -> None:
    assert invoke(["examples"]) == 0
    monkeypatch.delenv("CLEARANCE_SIMULATORS")
    forget_simulators()
    assert invoke([command, "docs/examples/campaigns/drop.yaml"]) == WRONG_INPUT
    errors = capsys.readouterr().err
    assert fields(errors) == ["simulator.name"]
    assert "CLEARANCE_SIMULATORS" in errors


@pytest.mark.parametrize("command", ["run", "validate"])
def test_a_simulator_that_was_not_built_is_named_with_the_reason(
    empty: Path, capsys: pytest.CaptureFixture[str], command: str
) -> None:
    assert invoke(["examples"]) == 0
    assert invoke([command, "docs/examples/campaigns/fmu_drop.yaml"]) == WRONG_INPUT
    errors = capsys.readouterr().err
    assert fields(errors) == ["simulator.name"]
    assert "model.fmu" in errors
