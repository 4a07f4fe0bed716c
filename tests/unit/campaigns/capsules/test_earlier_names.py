"""The names by which files of operators and packages of others import the engine, since before it had rooms."""

from __future__ import annotations

import importlib
import subprocess
import sys
from pathlib import Path

import pytest

import worker
from campaigns.capsules.sources import SourceFile

NAMES = (
    "worker.kernels.component",
    "worker.kernels.maths",
    "worker.kernels.views",
    "worker.kernels.space",
    "worker.kernels.shapes",
    "worker.physics.space",
    "worker.components.avoiders.closest_approach",
    "worker.search.base",
    "worker.systems.base",
    "worker.systems.simulators.logs.approach",
    "worker.catalogue.simulator",
    "worker.opening.opened",
    "worker.problem.problem",
)
"""Those that the guides of earlier versions showed."""


@pytest.mark.parametrize("name", NAMES)
def test_an_earlier_name_is_the_same_module(name: str) -> None:
    today = importlib.import_module(worker.today(name))
    assert importlib.import_module(name) is today
    assert today.__name__ == worker.today(name) != name
    assert today.__spec__ is not None
    assert today.__spec__.name == today.__name__


def test_whichever_name_comes_first_there_is_one_module() -> None:
    program = (
        "import worker.kernels.maths as a, worker.engine.kernels.maths as b, sys; assert a is b; print(b.__file__)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == importlib.import_module("worker.engine.kernels.maths").__file__


def test_a_name_that_never_was_is_not_found() -> None:
    for name in ("worker.nothing", "worker.kernels.nothing", "worker.kernelsx"):
        with pytest.raises(ModuleNotFoundError):
            importlib.import_module(name)


def test_every_earlier_package_leads_to_one_that_exists() -> None:
    for name in worker.EARLIER.values():
        path = Path(*name.split("."))
        assert (Path(worker.__file__).parents[1] / path).with_suffix(".py").exists() or importlib.import_module(name)


@pytest.mark.parametrize("module", ["worker.components.own.my_robot", "worker.engine.components.own.my_robot"])
def test_a_capsule_of_an_earlier_version_names_the_same_file(module: str) -> None:
    file = SourceFile(module=module, package=False, digest="0" * 64)
    assert (file.own, file.file) == (True, "my_robot.py")
