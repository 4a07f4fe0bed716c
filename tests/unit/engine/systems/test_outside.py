"""A function that reads files, the environment, the clock or random numbers is not identified, unless it declares its
data files; then an edit of one makes another function."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from campaigns.identity.identity import UNREAD
from tests.given.outside_state import CLOSED, READING, source
from worker.engine.systems.simulators.declared.folder import digest_of_place, files_of_place, reached_from
from worker.engine.systems.simulators.declared.outside import Outside
from worker.engine.systems.simulators.identity import identified

OPEN = Outside.FILES.clause("open")
DECLARED = """
import clearance
{first}
@clearance.simulator(parameters={{'x': (0.0, 1.0)}}{reads})
def fly(x):
    return {text}

def plotted():
    return open('other.csv').read()

if __name__ == "__main__":
    print(open('another.csv').read())
"""


def made(first: str, text: str) -> Callable[..., Any]:
    """A function as a notebook defines it."""
    space: dict[str, Any] = {"__name__": "notebook"}
    exec(source(first, text), space)
    function: Callable[..., Any] = space["fly"]
    return function


@pytest.mark.parametrize("form", READING)
def test_a_function_that_reads_state_outside_of_it_is_not_identified(form: str) -> None:
    assert identified(made(*READING[form])).unknown


@pytest.mark.parametrize("form", CLOSED)
def test_a_function_that_reads_nothing_is_identified(form: str) -> None:
    assert identified(made(*CLOSED[form])).unknown == ""


@pytest.mark.parametrize("form", READING)
def test_a_file_that_reads_state_outside_of_it_is_not_identified(form: str, tmp_path: Path) -> None:
    place = {"file": str(tmp_path / "fly.py"), "name": "fly"}
    Path(place["file"]).write_text(source(*READING[form]))
    assert digest_of_place(place).startswith(UNREAD)
    assert "of fly.py" in reached_from(place).unknown


@pytest.mark.parametrize("form", CLOSED)
def test_a_file_that_reads_nothing_is_identified(form: str, tmp_path: Path) -> None:
    place = {"file": str(tmp_path / "fly.py"), "name": "fly"}
    Path(place["file"]).write_text(source(*CLOSED[form]))
    assert reached_from(place).unknown == ""


def test_the_reason_has_name_and_line() -> None:
    assert identified(made(*READING["np.loadtxt"])).unknown == f"{Outside.FILES.clause('np.loadtxt')}, line 3 of fly"
    assert identified(made(*READING["the clock"])).unknown == f"{Outside.CLOCK.clause('time.time')}, line 3 of fly"


@pytest.mark.parametrize("text", ["open('table.csv').read()", "__import__('numpy').loadtxt('table.csv')"])
def test_a_declared_table_is_part_of_a_function(text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    table = tmp_path / "table.csv"
    function = made("import numpy", text.replace("__import__('numpy')", "numpy"))
    assert "missing" in identified(function, ["table.csv"]).unknown
    table.write_text("1.0")
    before = identified(function, ["table.csv"])
    assert before.unknown == ""
    assert identified(function, ["table.csv"]) == before
    table.write_text("2.0")
    assert identified(function, ["table.csv"]).digest != before.digest


def test_declared_files_excuse_files_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "table.csv").write_text("1.0")
    for form in ("the clock", "environ", "random", "subprocess", "urlopen"):
        assert identified(made(*READING[form]), ["table.csv"]).unknown


@pytest.mark.parametrize(
    ("first", "reads"),
    [
        ("", "reads=['table.csv']"),
        ("TABLES = ('table.csv',)", "reads=TABLES"),
        ("import pathlib\nHERE = pathlib.Path(__file__).parent", "reads=[HERE / 'table.csv']"),
        ("", "reads=['tables']"),
    ],
)
def test_a_declared_table_is_part_of_a_file(first: str, reads: str, tmp_path: Path) -> None:
    place = {"file": str(tmp_path / "fly.py"), "name": "fly"}
    text = "float(open('table.csv').read()) * x"
    Path(place["file"]).write_text(DECLARED.format(first=first, text=text, reads=""))
    assert f"{OPEN}, line {6 + first.count(chr(10))} of fly.py" in reached_from(place).unknown
    Path(place["file"]).write_text(DECLARED.format(first=first, text=text, reads=f", {reads}"))
    assert "missing" in reached_from(place).unknown
    table = tmp_path / ("tables/a.csv" if "tables" in reads else "table.csv")
    table.parent.mkdir(exist_ok=True)
    table.write_text("1.0")
    before = digest_of_place(place)
    assert not before.startswith(UNREAD), reached_from(place).unknown
    assert table in [path.resolve() for path in files_of_place(place)]
    table.write_text("2.0")
    assert digest_of_place(place) != before


def test_what_no_simulator_of_a_file_uses_does_not_count(tmp_path: Path) -> None:
    place = {"file": str(tmp_path / "fly.py"), "name": "fly"}
    Path(place["file"]).write_text(DECLARED.format(first="", text="2.0 * x", reads=""))
    assert reached_from(place).unknown == ""
    Path(place["file"]).write_text(DECLARED.format(first="", text="2.0 * x + len(plotted())", reads=""))
    assert f"{OPEN}, line 9 of fly.py" in reached_from(place).unknown


def test_a_path_in_reads_that_is_computed_is_named(tmp_path: Path) -> None:
    place = {"file": str(tmp_path / "fly.py"), "name": "fly"}
    Path(place["file"]).write_text(DECLARED.format(first="N = 1", text="x", reads=", reads=[f'{N}.csv']"))
    assert "reads, line 4" in reached_from(place).unknown
