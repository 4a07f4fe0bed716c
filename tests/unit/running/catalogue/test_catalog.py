"""Components and methods are found by presence, here and in other packages; the catalogue is data."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from campaigns import Catalogue, check
from campaigns.asked.load import load_document
from campaigns.catalogue import Kind, UnusableEntry
from campaigns.version import VERSION
from tests.given.case_campaigns import campaign, document
from tests.given.guest_packages import package
from worker.engine.systems.threads import usual_threads
from worker.running.catalogue import installed
from worker.running.catalogue.installed import catalogue, components, methods, source_of


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
    assert source_of(components()["vehicle", "unicycle"]).__name__ == "worker.engine.components.vehicles.unicycle"
    assert source_of(methods()["sqp"]).__name__ == "worker.engine.search.methods.sqp"


def test_what_is_described_once_is_kept_while_its_identity_stands_for_it() -> None:
    known = catalogue()
    for (role, name), component in components().items():
        kept, home = installed._HOMES[id(component)]
        assert kept is component, f"another {role} may get the identity of {name!r} and be taken to be of {home}"
        assert installed._SHIPPED[id(component)] is known.component(role, name)


def in_a_new_process(code: str, folder: Path) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(folder), os.getcwd()])}
    return subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, timeout=120, check=False
    )


CAR = '''"""Car: a unicycle by another name."""
from dataclasses import replace
from worker.engine.components.vehicles import unicycle
def begin(start, p):
    return start.x, start.y, start.theta, start.v, start.omega
component = replace(unicycle.component, name="{name}", title="Car", begin=begin)
'''
EVERY = (
    "import json; from worker.running.catalogue.installed import *; "
    "print(json.dumps([list(map(str, components())), list(methods())]))"
)


GUESS = """'Guessing.'
from dataclasses import replace
from worker.engine.search.methods import direct
method = replace(direct.method, name="guess")
"""
BREAKS = {
    "raising": "raise ValueError('not today')\n",
    "leaving": "import sys\nsys.exit('bye')\n",
    "empty": "X = 1.0\n",
    "missing": "import nowhere_at_all\n",
}
KINDS: tuple[Kind, ...] = ("component", "method", "simulator")


class Known(NamedTuple):
    """What an installation with other packages has."""

    components: list[str]
    methods: list[str]
    catalogue: dict[str, Any]

    def skipped(self, package: str) -> dict[str, Any]:
        """The entry of what is skipped of a package."""
        (entry,) = [e for e in self.catalogue["unusable"] if e["name"] == package]
        return dict(entry)


@pytest.fixture(scope="module")
def known(tmp_path_factory: pytest.TempPathFactory) -> Known:
    """One with the packages of all tests, each of which says by itself what becomes of it."""
    folder = tmp_path_factory.mktemp("packages")
    package(folder, "clearance.components", "some_car", CAR.format(name="car"))
    package(folder, "clearance.components", "another_unicycle", CAR.format(name="unicycle"))
    package(folder, "clearance.methods", "some_guess", GUESS)
    package(folder, "clearance.methods", "some_direct", "from worker.engine.search.methods.direct import method\n")
    for kind in KINDS:
        for how, text in BREAKS.items():
            package(folder, f"clearance.{kind}s", f"{how}_{kind}", text)
    done = in_a_new_process(f"{EVERY}; print(catalogue().model_dump_json())", folder)
    assert done.returncode == 0, done.stderr
    every, described = map(json.loads, done.stdout.splitlines())
    return Known(*every, described)


@pytest.mark.nightly
def test_a_component_and_a_method_of_another_package_are_found_and_none_is_lost(known: Known) -> None:
    car = "('vehicle', 'car')"
    assert car in known.components
    assert "guess" in known.methods
    assert [c for c in known.components if c != car] == list(map(str, components()))
    assert [m for m in known.methods if m != "guess"] == list(methods())


def test_a_second_component_of_one_name_is_skipped_and_reported(known: Known) -> None:
    assert "unicycle" in known.skipped("another_unicycle")["text"]
    assert "another_unicycle" in known.skipped("another_unicycle")["text"]
    (mine,) = [c for c in known.catalogue["components"] if (c["role"], c["name"]) == ("vehicle", "unicycle")]
    assert mine["title"] != "Car"


def test_only_what_is_broken_or_repeats_a_name_is_skipped(known: Known) -> None:
    broken = {f"{how}_{kind}" for how in BREAKS for kind in KINDS}
    assert {e["name"] for e in known.catalogue["unusable"]} == broken | {"another_unicycle", "some_direct"}


@pytest.mark.parametrize("kind", KINDS)
def test_what_a_package_breaks_is_skipped_with_its_sentence(kind: Kind, known: Known) -> None:
    entries = {how: known.skipped(f"{how}_{kind}") for how in BREAKS}
    assert {entry["kind"] for entry in entries.values()} == {kind}
    texts = {how: entry["text"] for how, entry in entries.items()}
    assert [how for how, text in texts.items() if text.startswith(f"the package {how}_{kind}: ")] == list(texts)
    assert texts["raising"].endswith("(ValueError: not today)")
    assert texts["leaving"].endswith("(SystemExit: bye)")
    assert "(ModuleNotFoundError: " in texts["missing"]
    assert "Error" not in texts["empty"]


def test_a_method_with_the_name_of_a_shipped_one_is_skipped(known: Known) -> None:
    text = known.skipped("some_direct")["text"]
    assert text.startswith("the package some_direct: worker.engine.search.methods.direct ")
    assert " method 'direct'" in text


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
def test_a_campaign_that_names_what_is_broken_is_refused_with_its_sentence(
    kind: Kind, given: dict[str, Any], field: str
) -> None:
    """And of what is broken under the same name, only the sentence of its kind."""
    every: list[Kind] = ["component", "method", "simulator"]
    broken = [UnusableEntry(file="", line=None, name="broken", text=f"broken {k}", kind=k) for k in every]
    known: Catalogue = catalogue().model_copy(update={"unusable": broken})
    found = [p for p in check(load_document(given, "test"), known) if p.field == field]
    assert [p.message.rpartition(": ")[2] for p in found] == [f"broken {kind}"]


@pytest.mark.parametrize(("given", "expected"), [("3", 3), ("0", None), ("", None), ("many", None), ("-2", None)])
def test_the_number_of_threads(monkeypatch: pytest.MonkeyPatch, given: str, expected: int | None) -> None:
    monkeypatch.setenv("CLEARANCE_THREADS", given)
    assert usual_threads() == (expected or len(os.sched_getaffinity(0)))


def test_the_shipped_campaigns_name_their_units() -> None:
    for path, uncertain in campaign().uncertain.items():
        assert uncertain.unit, path
