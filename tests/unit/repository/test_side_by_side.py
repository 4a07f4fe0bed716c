"""Tests in forks of the process that collected them report what they would in one; see tests/side_by_side.py."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.faults.processes import alive, until

ODD = """
import os, time, warnings
import pytest

@pytest.fixture(scope="session", autouse=True)
def ended():
    yield
    print("ended by", os.getpid())
    raise RuntimeError("the last of all")

def test_passes(tmp_path): pass
def test_fails(): print("what it printed"); assert 1 == 2
@pytest.mark.skip(reason="not here")
def test_is_skipped(): pass
@pytest.mark.xfail(strict=True)
def test_fails_as_expected(): assert 0
def test_dies(): os.kill(os.getpid(), 9)
def test_is_run_by_another_process(): assert os.getppid() == int(os.environ["PARENT"])
@pytest.mark.timeout(0.1)
def test_hangs(): time.sleep(60)
def test_warns(): warnings.warn("of something")
"""
PLAIN = """
import os, pytest
os.environ["PARENT"] = str(os.getpid())  # while it is collected

@pytest.mark.parametrize("number", range(20))
def test_passes(number): assert os.getpid() != int(os.environ["PARENT"])
"""


def pytest_in(folder: Path, *arguments: str) -> tuple[list[str], dict[str, str]]:
    """The command and the environment of a run of its own in a folder."""
    plugins = ["-p", "pytest_timeout", "-p", "tests.side_by_side"]
    command = [sys.executable, "-m", "pytest", *plugins, "-c", "empty.ini", "-ra", *arguments]
    (folder / "empty.ini").write_text("[pytest]\n", encoding="utf-8")
    # To load all installed plugins takes longer than the tests.
    paths = {"PYTHONPATH": str(Path(__file__).parents[3]), "PYTEST_ADDOPTS": "", "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    return command, os.environ | paths


def in_folder(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    command, environment = pytest_in(folder, *arguments)
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=120)


def test_every_outcome_is_reported_and_a_process_that_dies_takes_no_test_with_it(tmp_path: Path) -> None:
    (tmp_path / "test_a_odd.py").write_text(ODD, encoding="utf-8")
    (tmp_path / "test_b_plain.py").write_text(PLAIN, encoding="utf-8")
    result = in_folder(tmp_path, "--processes", "2")
    counts = {"failed": 3, "passed": 23, "skipped": 1, "xfailed": 1, "warning": 1}
    last = result.stdout.splitlines()[-1]
    statement = re.findall(r"(\d+) (failed|passed|skipped|xfailed|warning)", last)
    assert {word: int(number) for number, word in statement} == counts
    assert re.search(r"\d errors?\b", last)
    texts = (
        "\nfailed: test_a_odd.py::test_fails\n",
        "test_dies - process",
        "ended by signal 9",
        "what it printed",
        "Timeout (>0.1s)",
        "the last of all",
    )
    assert [text for text in texts if text not in result.stdout] == []
    assert result.returncode == 1, result.stderr


ENDLESS = """
import os, subprocess, sys, time
from pathlib import Path
import pytest

@pytest.fixture
def service():
    with subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"]) as started:
        yield started.pid
        started.kill()

def test_waits(service):
    Path(f"begun-{os.getpid()}-{service}").touch()
    time.sleep(600)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux tells a process that its parent has ended")
def test_processes_end_with_the_one_that_started_them_and_end_what_they_started(tmp_path: Path) -> None:
    for name in ("test_a", "test_b"):
        (tmp_path / f"{name}.py").write_text(ENDLESS, encoding="utf-8")
    command, environment = pytest_in(tmp_path, "--processes", "2")
    with subprocess.Popen(command, cwd=tmp_path, env=environment, stdout=subprocess.DEVNULL) as parent:
        until(lambda: len(list(tmp_path.glob("begun-*"))) == 2, "both are under way")
        parent.kill()
    pids = [int(pid) for file in tmp_path.glob("begun-*") for pid in file.name.split("-")[1:]]
    assert len(pids) == 4
    until(lambda: not any(map(alive, pids)), "all have ended", 20)


WAITING = """
import pytest

def pytest_waits(item): return item.path.name.startswith("test_w")
"""
TURN = """
import os
from pathlib import Path

def test_turn():
    with Path("order").open("a") as file:
        file.write(f"{os.environ['PYTEST_CURRENT_TEST'][:6]}\\n")
"""


@pytest.mark.nightly  # an order, which changes no outcome
def test_the_first_process_begins_with_what_waits(tmp_path: Path) -> None:
    (tmp_path / "conftest.py").write_text(WAITING, encoding="utf-8")
    for name in ("test_c1", "test_c2", "test_w1", "test_w2"):
        (tmp_path / f"{name}.py").write_text(TURN, encoding="utf-8")
    result = in_folder(tmp_path, "--processes", "1")
    assert result.returncode == 0, result.stdout
    assert [line[5] for line in (tmp_path / "order").read_text().split()] == ["w", "w", "c", "c"]
