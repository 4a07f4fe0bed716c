"""The guide on own components: its table is what components declare, its example in space is the files, and flies."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from campaigns import check, load_file
from worker.engine.components import own as own_package
from worker.engine.kernels.component import Component, Controller, Vehicle
from worker.running.catalogue import installed
from worker.running.catalogue.entries import component_entry
from worker.running.catalogue.installed import components, source_of
from worker.running.examination import reading
from worker.running.examination.declaring import declared_by
from worker.running.examination.flying import flown

REPOSITORY = Path(__file__).parents[4]
GUIDE = (REPOSITORY / "docs" / "your-own-component.md").read_text(encoding="utf-8")
EXAMPLES = REPOSITORY / "docs" / "examples"


def test_the_table_of_controllers_is_what_they_declare() -> None:
    lines = GUIDE.partition("| vehicle | dimension |")[2].splitlines()[2:]
    rows = [line for line in lines[: lines.index("")] if line]
    controllers = [c for c in components().values() if isinstance(c, Controller)]
    for vehicle in sorted((c for c in components().values() if isinstance(c, Vehicle)), key=lambda v: v.name):
        fit = sorted((c for c in controllers if vehicle.name in c.fits), key=lambda c: c.name)
        demands = ", ".join(sorted({kind for c in fit for kind in c.command}))
        names = ", ".join(f"`{c.name}`" for c in fit)
        assert rows.pop(0) == f"| `{vehicle.name}` | {vehicle.dimension} | {names} | {demands} |"
    assert rows == []


@pytest.mark.nightly
def test_the_example_in_space_is_that_of_the_files_and_can_be_simulated(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = re.findall(r"^```(?:py|yml)\n(.*?)^```$", GUIDE, re.MULTILINE | re.DOTALL)
    for file in ("components/multirotor.py", "components/multirotor_velocity.py", "campaigns/multirotor.yaml"):
        assert (EXAMPLES / file).read_text(encoding="utf-8") in shown, file
    monkeypatch.setattr(own_package, "__path__", [str(EXAMPLES / "components")])
    found: list[Component] = []
    for name in ("multirotor", "multirotor_velocity"):
        source = reading.read(EXAMPLES / "components" / f"{name}.py")
        reading.check(source)
        found.append(declared_by(source, f"worker.engine.components.own.{name}"))
        flown(found[-1], source, {"multirotor": found[0]}.get)
    shipped = installed.catalogue().components  # before their homes are replaced
    monkeypatch.setattr(installed, "_HOMES", {id(c): (c, f"worker.engine.components.own.{c.name}") for c in found})
    entries = [*shipped, *(component_entry(c, source_of(c)) for c in found)]
    known = installed.catalogue().model_copy(update={"components": entries})
    assert check(load_file(EXAMPLES / "campaigns" / "multirotor.yaml"), known) == []


def test_the_files_of_the_example_are_on_no_path_of_this_repository() -> None:
    assert not {"multirotor", "multirotor_velocity"} & {name for _, name in components()}
    assert sorted(p.name for p in Path(EXAMPLES / "components").glob("*.py")) == [
        "multirotor.py",
        "multirotor_velocity.py",
    ]
