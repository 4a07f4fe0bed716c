"""The contracts of `clearance.testing` in the tests of a package: a good guest passes them, a broken one fails."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from campaigns import library, load_file
from tests.given.guest_packages import package
from tests.simulators import package as simulators

UNIFORM = '''"""Uniform: independent uniform points.

It guarantees nothing.
"""
from dataclasses import dataclass, replace
from worker.engine.search.base import Method, Search, Space

@dataclass(frozen=True)
class Options:
    """It has none."""

def search(space: Space, options: Options) -> Search:
    while True:
        yield space.random.random((20, space.dimension))

def outside(space: Space, options: Options) -> Search:
    while True:
        yield 2.0 * space.random.random((20, space.dimension))

method = Method(
    name="uniform", title="Uniform", kind="global", how="Draws independent points", source="Metropolis and Ulam 1949",
    evaluations=1000, options=Options, search=search, family="sampling", whole_budget=True,
    parallel="any number", suits="a first impression",
)
broken = replace(method, search=outside)
'''
PILLAR = '''"""Pillar: a circle whose parameters have other names.

For a test.
"""
from dataclasses import replace
from worker.engine.components.obstacles import circle
component = replace(circle.component, name="pillar")
'''
HIDDEN = '''"""hidden"""
from dataclasses import replace
from worker.engine.components.obstacles import circle
component = replace(circle.component, name="hidden", title="hidden")
'''
RANDOM = '''"""Restless: a circle of which nobody knows where it is.

For a test.
"""
import random
from dataclasses import replace
from worker.engine.components.obstacles import circle
from worker.engine.kernels.maths import kernel
from worker.engine.kernels.views import Body

steady = circle.component.body

@kernel
def body(t, o, q, p):
    found, shift = steady(t, o, q, p), 0.001 * random.random()
    gap = found.gap + shift  # no surface beyond the reach
    return Body(found.x + shift, found.y, found.vx, found.vy, found.radius, gap, found.nx, found.ny)

component = replace(circle.component, name="restless", body=body)
'''
TESTS = """
import numpy as np
from basins import ENTRY, TwoBasins
from clearance.testing import ComponentContract, MethodContract, SystemContract
from campaigns.asked.load import load_document
from worker.engine.problem.problem import Problem
from worker.engine.systems.simulators.declared.simulator import Opening
from tests.simulators import package
import hidden
import pillar
import restless
import uniform

class TestMethod(MethodContract):
    method = uniform.method

class TestBrokenMethod(MethodContract):
    method = uniform.broken

class TestComponent(ComponentContract):
    component = pillar.component

class TestBrokenComponent(ComponentContract):
    component = hidden.component
    test_compiled_it_is_as_in_plain_python = None  # takes seconds

class TestRandomComponent(ComponentContract):
    component = restless.component
    test_compiled_it_is_as_in_plain_python = None

class TestSimulator(SystemContract):
    campaign = package.campaign()
    failing = 0.99

class Noisy(TwoBasins):
    def evaluate(self, vectors, seeds=None):
        batch, reasons = super().evaluate(vectors, seeds)
        return batch._replace(costs=batch.costs + np.random.default_rng().random(batch.costs.shape)), reasons

class TestBrokenSimulator(TestSimulator):
    @classmethod
    def open(cls):
        opening = Opening({"simulator.x": 0.5, "simulator.y": 0.45}, "separation")
        return Problem(load_document(cls.campaign), Noisy(ENTRY, opening))
"""


@pytest.fixture(scope="module")
def outcomes(tmp_path_factory: pytest.TempPathFactory) -> dict[str, set[str]]:
    """The failed tests of every class of a package's own test file."""
    folder = tmp_path_factory.mktemp("guests")
    simulators.install(folder)
    package(folder, "clearance.methods", "uniform", UNIFORM)
    package(folder, "clearance.components", "pillar", PILLAR)
    package(folder, "clearance.components", "hidden", HIDDEN)
    package(folder, "clearance.components", "restless", RANDOM)
    (folder / "test_guests.py").write_text(TESTS, encoding="utf-8")
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-rA", "--tb=no", "test_guests.py"]
    environment = {**os.environ, "PYTHONPATH": simulators.path(folder)}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 1, done.stdout + done.stderr
    found: dict[str, set[str]] = {}
    for word, name, test in re.findall(r"^(PASSED|FAILED) test_guests\.py::(\w+)::(\w+)", done.stdout, re.MULTILINE):
        found.setdefault(name, set()).update({test} if word == "FAILED" else ())
    return found


@pytest.mark.by_day(1)
@pytest.mark.parametrize("name", ["TestMethod", "TestComponent", "TestSimulator"])
def test_a_good_guest_passes(outcomes: dict[str, set[str]], name: str) -> None:
    assert outcomes[name] == set()


def test_a_broken_guest_fails_where_it_is_broken(outcomes: dict[str, set[str]]) -> None:
    assert "test_points_are_points_of_the_unit_cube" in outcomes["TestBrokenMethod"]
    assert outcomes["TestBrokenComponent"] == {"test_it_is_documented"}
    assert "test_the_same_case_gives_the_same_bits" in outcomes["TestRandomComponent"]
    assert "test_bits_depend_on_the_vector_alone" in outcomes["TestBrokenSimulator"]


@pytest.mark.nightly
def test_no_run_begins_with_a_component_that_is_random(tmp_path: Path) -> None:
    """One of a package, which nobody has examined."""
    package(tmp_path, "clearance.components", "restless", RANDOM)
    document = load_file(library()["unicycle_static"]).document()
    document["scenario"] |= {"horizon": 2.0}
    document["scenario"]["obstacles"][0] |= {"component": "restless"}
    (tmp_path / "campaign.json").write_text(json.dumps(document), encoding="utf-8")
    command = [sys.executable, "-m", "clearance", "run", "campaign.json"]
    environment = {**os.environ, "PYTHONPATH": simulators.path(tmp_path)}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode not in (0, 1), done.stdout
    shown = " ".join((done.stdout + done.stderr).split())
    assert re.search(r"gave different results: .*obstacle restless", shown), shown


@pytest.mark.nightly
def test_it_needs_no_pytest() -> None:
    code = "import sys; sys.modules['pytest'] = None; import clearance.testing"
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.nightly  # it compiles all that they import
def test_contracts_refuse_to_run_without_their_asserts() -> None:
    ended = subprocess.run([sys.executable, "-O", "-c", "import clearance.testing"], capture_output=True, text=True)
    assert ended.returncode == 1
    assert "python -O" in ended.stderr
