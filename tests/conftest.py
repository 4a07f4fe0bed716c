"""The order of test files, slow ones first, so that all processes finish at the same time; garbage collection; and
properties, which have no deadline, because no test depends on time, and the same examples in every run."""

from __future__ import annotations

from worker.running.processes import blas as blas  # before numpy is loaded

# isort: split
import gc
import os
import re
import ssl
import sys
from collections.abc import Generator
from functools import cache
from importlib import import_module

import httpx
import pytest
from hypothesis import HealthCheck, settings
from numba.core.registry import cpu_target

from tests import statements
from tests.given.at_night import others
from tests.migrated import empty
from tests.side_by_side import pytest_addoption, pytest_runtestloop

__all__ = ["pytest_addoption", "pytest_runtestloop"]

LONG = (
    "/e2e/",
    "faults/test_worker.py",
    "faults/test_releases.py",
    "faults/test_outages.py",
    "faults/test_backup.py",
    "faults/test_kill.py",
    "faults/test_serve.py",
    "faults/test_code.py",
    "faults/test_cluster.py",
    "adversary/",
    "physics/test_uav_cases.py",
    "contract/test_methods.py",
    "contract/test_compiled.py",
    "unit/evidence/audit/",
    "api/runs/test_simulators.py",
    "physics/test_reproduce.py",
    "physics/test_realisations.py",
    "physics/test_criteria.py",
    "physics/test_step_adequacy.py",
)
"""Parts of the paths of long files."""

BROWSED = {
    **dict.fromkeys(("browse", "isolation", "narrow", "reading_a_run", "simulator", "simulator_run"), "evaluated"),
    "whole_way": "whole_way",
}
"""By file of tests/e2e, the group that stays in one process, where it shares browsers; all others are one more group.
Those that need the fixture `flown` are together. The groups take about as long as each other."""

SPREAD = ("contract/test_compiled.py",)
"""Files whose tests share only a closed loop: tests whose ids start with the same number stay together."""

UMASK = os.umask(0)
os.umask(UMASK)


def pytest_group_of(item: pytest.Item) -> str:
    """Tests of a file share services and stay in one process, those of a group of `BROWSED` too. Some are spread."""
    file, _, rest = item.nodeid.partition("::")
    if browsed := re.fullmatch(r"tests/e2e/test_(\w+)\.py", file):
        return f"tests/e2e: {BROWSED.get(browsed[1], 'others')}"
    if file.startswith("tests/api/"):
        if "postgresql" in rest:
            return "tests/api: postgresql"  # one server for all
        if "process" in getattr(item, "fixturenames", ()):
            return "tests/api: simulating"  # one process for all
    if file.startswith("tests/unit/") and "live" in getattr(item, "fixturenames", ()):
        return "tests/unit: live"
    number = re.search(r"\[(\d+)-", rest)
    return f"{file}[{number[1]}]" if number and file.endswith(SPREAD) else file


def pytest_waits(item: pytest.Item) -> bool:
    """Tests of browsers and of processes."""
    return item.nodeid.startswith(("tests/e2e/", "tests/faults/"))


@pytest.hookimpl(tryfirst=True)  # before tests are left out by their marks
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The long files first, all others as they come. What `by_day` leaves out is nightly."""
    for item in others(items):
        item.add_marker(pytest.mark.nightly)

    def turn(item: pytest.Item) -> int:
        path = item.path.as_posix()
        return next((i for i, name in enumerate(LONG) if name in path), len(LONG))

    items.sort(key=turn)


def pytest_configure() -> None:
    """Collecting makes hardly any garbage."""
    slow = [HealthCheck.too_slow]
    settings.register_profile("clearance", deadline=None, derandomize=True, database=None, suppress_health_check=slow)
    settings.load_profile("clearance")
    gc.disable()
    statements.share()


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Test modules are stored as they are with their assertions rewritten, also where the environment forbids to write
    what was compiled: it takes half of the collection. Processes that tests start do as the environment says."""
    forbidden, sys.dont_write_bytecode = sys.dont_write_bytecode, False
    try:
        return (yield)
    finally:
        sys.dont_write_bytecode = forbidden


def pytest_runtest_teardown() -> None:
    """A command that a test calls in this process may keep what is made later private."""
    os.umask(UMASK)


def load() -> None:
    """Once for all forks, what most of them need: a second for each. All clients have one list of authorities."""
    for name in ("cma", "SALib.sample.sobol", "SALib.analyze.sobol"):
        import_module(name)
    cpu_target.target_context.refresh()
    ssl.create_default_context = cache(ssl.create_default_context)
    httpx.create_ssl_context()
    empty()


def pytest_collection_finish(session: pytest.Session) -> None:
    """From here on only what the tests make is searched for cycles.

    A process that has collected all tests holds 800,000 objects, none of which ends before it does. Searching them
    again and again took a third of the collection and a fifth of the tests' time.
    """
    if session.config.getoption("processes"):
        load()
    gc.collect()
    gc.freeze()
    gc.set_threshold(200_000, 20, 20)
    gc.enable()
