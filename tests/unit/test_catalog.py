"""Components and methods are found by presence, here and in other packages; the catalogue is data."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from campaigns import Catalogue, check
from campaigns.asked.load import load_document
from campaigns.catalogue import Kind, UnusableEntry
from campaigns.version import VERSION
from tests.unit.cases import campaign, document
from tests.unit.packages import package
from worker.catalogue.installed import catalogue, components, methods, source_of
from worker.systems.threads import usual_threads


def test_case_1_is_there() -> None:
    assert components().keys() >= {
        ("vehicle", "unicycle"), ("controller", "pid_speed"), ("avoider", "potential_field"), ("obstacle", "circle"),
        ("criterion", "separation"),
    }  # fmt: skip
    assert methods().keys() >= {"direct", "sqp", "monte_carlo"}
    for (role, name), component in components().items():
        assert (component.role, component.name) == (role, name)


def test_the_catalogue_is_data() -> None:
    known = catalogue()
    assert known.version == VERSION
    assert Catalogue.model_validate_json(known.model_dump_json()) == known
    mass = next(p for c in known.components if c.name == "unicycle" for p in c.parameters if p.name == "m")
    assert (mass.symbol, mass.unit, mass.low, mass.high, mass.default) == ("m", "kg", 1e-3, 1e5, 5.0)
    unicycle = known.component("vehicle", "unicycle")
    assert unicycle is not None
    assert [p.name for p in unicycle.starts] == ["x", "y", "theta", "v", "omega"]
    assert known.component("vehicle", "circle") is None
    assert known.method("magic") is None


def test_where_a_thing_is_declared() -> None:
    assert source_of(components()["vehicle", "unicycle"]).__name__ == "worker.components.vehicles.unicycle"
    assert source_of(methods()["sqp"]).__name__ == "worker.search.methods.sqp"


def in_a_new_process(code: str, folder: Path) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(folder), os.getcwd()])}
    return subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, timeout=120, check=False
    )


CAR = '''"""Car: a unicycle by another name."""
from dataclasses import replace
from worker.components.vehicles import unicycle
def begin(start, p):
    return start.x, start.y, start.theta, start.v, start.omega
component = replace(unicycle.component, name="{name}", title="Car", begin=begin)
'''
EVERY = (
    "import json; from worker.catalogue.installed import *; "
    "print(json.dumps([list(map(str, components())), list(methods())]))"
)


def test_a_component_of_another_package_is_found(tmp_path: Path) -> None:
    package(tmp_path, "clearance.components", "some_car", CAR.format(name="car"))
    done = in_a_new_process(EVERY, tmp_path)
    assert done.returncode == 0, done.stderr
    found: list[Any] = json.loads(done.stdout)
    assert "('vehicle', 'car')" in found[0]


def test_a_method_of_another_package_is_found(tmp_path: Path) -> None:
    text = '"""Guessing."""\nfrom dataclasses import replace\nfrom worker.search.methods import direct\n'
    text += 'method = replace(direct.method, name="guess")\n'
    package(tmp_path, "clearance.methods", "some_guess", text)
    done = in_a_new_process(EVERY, tmp_path)
    assert done.returncode == 0, done.stderr
    assert "guess" in json.loads(done.stdout)[1]


def test_a_second_component_of_one_name_is_skipped_and_said_to_be(tmp_path: Path) -> None:
    package(tmp_path, "clearance.components", "some_car", CAR.format(name="unicycle"))
    told = "; from worker.catalogue.installed import catalogue; print(catalogue().model_dump_json())"
    done = in_a_new_process(EVERY + told, tmp_path)
    assert done.returncode == 0, done.stderr
    every, known = map(json.loads, done.stdout.splitlines())
    assert every == json.loads(in_a_new_process(EVERY, Path.cwd()).stdout)
    (skipped,) = known["unusable"]
    assert "some_car" in skipped["text"]
    assert "unicycle" in skipped["text"]
    mine = [c for c in known["components"] if (c["role"], c["name"]) == ("vehicle", "unicycle")]
    assert len(mine) == 1


@pytest.mark.parametrize("kind", ["component", "method", "simulator"])
def test_what_a_package_breaks_is_skipped_with_its_sentence(kind: Kind, tmp_path: Path) -> None:
    group = f"clearance.{kind}s"
    package(tmp_path, group, "some_raising", "raise ValueError('not today')\n")
    package(tmp_path, group, "some_leaving", "import sys\nsys.exit('bye')\n")
    package(tmp_path, group, "some_empty", "X = 1.0\n")
    package(tmp_path, group, "some_missing", "import nowhere_at_all\n")
    done = in_a_new_process(f"{EVERY}; print(catalogue().model_dump_json())", tmp_path)
    assert done.returncode == 0, done.stderr
    every, known = map(json.loads, done.stdout.splitlines())
    assert every == json.loads(in_a_new_process(EVERY, Path.cwd()).stdout)
    assert {entry["kind"] for entry in known["unusable"]} == {kind}
    texts = {entry["name"]: entry["text"] for entry in known["unusable"]}
    assert texts["some_raising"] == "the package some_raising: it cannot be loaded (ValueError: not today)"
    assert texts["some_leaving"] == "the package some_leaving: it cannot be loaded (SystemExit: bye)"
    assert texts["some_missing"].startswith("the package some_missing: it cannot be loaded (ModuleNotFoundError: ")
    assert texts["some_empty"].startswith("the package some_empty: it ")


def test_a_method_with_the_name_of_a_shipped_one_is_skipped(tmp_path: Path) -> None:
    package(tmp_path, "clearance.methods", "some_direct", "from worker.search.methods.direct import method\n")
    done = in_a_new_process(f"{EVERY}; print(catalogue().model_dump_json())", tmp_path)
    assert done.returncode == 0, done.stderr
    (skipped,) = json.loads(done.stdout.splitlines()[1])["unusable"]
    assert skipped["text"] == (
        "the package some_direct: worker.search.methods.direct already declares the method 'direct': rename one of them"
    )


SIMULATED: dict[str, Any] = {
    "name": "Asked",
    "simulator": {"name": "broken"},
    "uncertain": {"simulator.a": {"low": 0.0, "high": 1.0}},
    "criterion": {"result": "d", "threshold": 0.5},
    "stages": {"search": [{"method": "direct", "evaluations": 10}]},
}


@pytest.mark.parametrize(
    ("kind", "given", "field"),
    [
        ("component", document(scenario__vehicle__component="broken"), "scenario.vehicle.component"),
        ("method", document(stages__search__0__method="broken"), "stages.search.0.method"),
        ("simulator", SIMULATED, "simulator.name"),
    ],
)
def test_a_campaign_that_names_what_is_broken_is_told_its_sentence(
    kind: Kind, given: dict[str, Any], field: str
) -> None:
    """And of what is broken under the same name, only the sentence of its kind."""
    every: list[Kind] = ["component", "method", "simulator"]
    broken = [
        UnusableEntry(file="", line=None, name="broken", text=f"the {k} is broken: mend it", kind=k) for k in every
    ]
    known: Catalogue = catalogue().model_copy(update={"unusable": broken})
    found = [p for p in check(load_document(given, "test"), known) if p.field == field]
    assert [p.message for p in found] == [f"it cannot be used: the {kind} is broken: mend it"]


def test_the_campaigns_do_not_import_the_physics() -> None:
    code = "import sys, campaigns; print(json.dumps(sorted(m for m in sys.modules if '.' not in m)))"
    done = in_a_new_process(f"import json; {code}", Path.cwd())
    loaded = json.loads(done.stdout)
    assert "campaigns" in loaded
    assert not {"worker", "backend", "numba", "numpy", "scipy"} & set(loaded)


@pytest.mark.parametrize(("given", "expected"), [("3", 3), ("0", None), ("", None), ("many", None), ("-2", None)])
def test_the_number_of_threads(monkeypatch: pytest.MonkeyPatch, given: str, expected: int | None) -> None:
    monkeypatch.setenv("CLEARANCE_THREADS", given)
    assert usual_threads() == (expected or len(os.sched_getaffinity(0)))


def test_the_shipped_campaigns_name_their_units() -> None:
    for path, uncertain in campaign().uncertain.items():
        assert uncertain.unit, path
