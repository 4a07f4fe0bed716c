"""Tests in forks of the process that collected them report what they would in one; see tests/side_by_side.py."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.nightly

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


def in_folder(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    plugins = ["-p", "pytest_timeout", "-p", "tests.side_by_side"]
    command = [sys.executable, "-m", "pytest", *plugins, "-c", "empty.ini", "-ra", *arguments]
    (folder / "empty.ini").write_text("[pytest]\n", encoding="utf-8")
    # To load all installed plugins takes longer than the tests.
    paths = {"PYTHONPATH": str(Path(__file__).parents[3]), "PYTEST_ADDOPTS": "", "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    return subprocess.run(command, cwd=folder, env=os.environ | paths, capture_output=True, text=True, timeout=120)


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
