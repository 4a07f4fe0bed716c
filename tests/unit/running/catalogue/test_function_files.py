"""Python files in the operator's folder: what they declare, and what is reported of those that cannot be used."""

from __future__ import annotations

import errno
import os
import sys
from pathlib import Path
from types import ModuleType

import pytest

from campaigns.asked.load import load_document
from tests.simulators import isolated
from worker.engine.systems.base import CampaignUnusable
from worker.engine.systems.simulators.declared.folder import FOLDERS, digest_of_place
from worker.running.catalogue import files
from worker.running.catalogue.files import BadFile, PythonFunction, listed_files, unusable_simulators
from worker.running.catalogue.installed import _simulators_of, catalogue
from worker.running.opening import opened

GOOD = """
import clearance

@clearance.simulator(parameters={"mass": clearance.Parameter(1, 3, unit="kg")}, title="Drop", timeout=5)
def drop(mass):
    "It falls."
    return mass
"""
BAD = {
    "broken.py": ("import clearance\nx = = 3", "line 2: SyntaxError"),
    "dies.py": ("import clearance, os\nos._exit(3)", "loading it ended the process with exit code 3"),
    "exits.py": ("import clearance, sys\nsys.exit('no')", "it calls sys.exit('no') when it is loaded"),
    "missing.py": ("import clearance\nimport no_such", "ModuleNotFoundError: No module named 'no_such', at line 2"),
    "searches.py": ("import clearance\nclearance.search(None, {}, 0)", "under `if __name__ == '__main__':`, at line 2"),
    "wrong.py": (GOOD.replace("(1, 3", "(3, 1"), "ValueError: mass: low 3 must be below high 1 [kg], at line 4"),
}  # fmt: skip


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv(FOLDERS, str(tmp_path))
    return tmp_path


def test_a_file_is_a_simulator(folder: Path) -> None:
    (folder / "good.py").write_text(GOOD)
    (folder / "helper.py").write_text("import os\nos._exit(1)")  # without clearance, so it is not loaded
    (found,) = listed_files()
    assert isinstance(found, PythonFunction)
    assert found.place == {"file": str(folder / "good.py"), "name": "drop"}
    assert found.declaration.settings.timeout == 5.0
    assert (found.entry.name, found.entry.title, found.entry.text) == ("drop", "Drop", "It falls.")
    (parameter,) = found.entry.parameters
    assert (parameter.low, parameter.default, parameter.high, parameter.unit) == (1.0, 2.0, 3.0, "kg")
    assert unusable_simulators() == []


def test_files_that_cannot_be_used_are_reported_and_skipped(folder: Path) -> None:
    for name, (text, _) in BAD.items():
        (folder / name).write_text(text)
    found = unusable_simulators()
    assert [line.partition(":")[0] for line in found] == [str(folder / name) for name in sorted(BAD)]
    for line, name in zip(found, sorted(BAD), strict=True):
        assert BAD[name][1] in line
    assert all(isinstance(file, BadFile) for file in listed_files())


def test_an_endless_file_is_stopped(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(files, "LONGEST", 0.5)
    (folder / "endless.py").write_text("import clearance\nwhile True: pass")
    (line,) = unusable_simulators()
    assert "more than 0.5 s" in line


def test_a_name_is_declared_once(folder: Path) -> None:
    for name in ("first.py", "second.py"):
        (folder / name).write_text(GOOD)
    (line,) = unusable_simulators()
    assert line.startswith(str(folder / "second.py"))
    assert "first.py " in line
    assert " simulator drop;" in line


def test_the_digest_is_that_of_the_python_files(folder: Path) -> None:
    (folder / "good.py").write_text(GOOD)
    place = {"file": str(folder / "good.py"), "name": "drop"}
    found = [digest_of_place(place)]
    (folder / "notes.txt").write_text("text")
    assert digest_of_place(place) == found[0]
    for name in ("helper.py", "package/__init__.py", "package/inner.py"):
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text("X = 1")
        found.append(digest_of_place(place))
    (folder / "helper.py").write_text("X = 2")
    found.append(digest_of_place(place))
    assert len(set(found)) == len(found) == 5


def test_an_entry_point_names_a_function_or_a_module_of_them() -> None:
    named = _simulators_of(isolated, "alone")
    assert [s.place for s in named] == [{"module": "tests.simulators.isolated", "name": "alone"}]  # type: ignore[union-attr]
    every = _simulators_of(isolated, "")
    assert [s.entry.name for s in every] == ["alone", "misbehaving"]
    module = ModuleType("one")
    module.simulator = isolated.alone  # type: ignore[attr-defined]
    assert [s.entry.name for s in _simulators_of(module, "")] == ["alone"]
    assert _simulators_of(isolated, "RESULTS") == []
    assert digest_of_place({"module": "tests.simulators.isolated", "name": "alone"}) == digest_of_place(
        {"module": "tests"}
    )


def test_a_declaration_that_changed_is_refused(folder: Path) -> None:
    file = folder / "good.py"
    file.write_text(GOOD)
    (listed,) = listed_files()
    assert isinstance(listed, PythonFunction)
    document = {
        "name": "Drop",
        "simulator": {"name": "drop"},
        "uncertain": {"simulator.mass": {"low": 1.5, "high": 2.5}},
        "criterion": {"result": "value", "threshold": 0.0},
        "stages": {"search": [{"method": "direct", "evaluations": 10}]},
    }
    campaign, known = load_document(document), catalogue().model_copy(update={"simulators": [listed.entry]})
    before = opened.simulated(campaign, listed, known)
    file.write_text(GOOD + "# a remark\n")
    assert opened.simulated(campaign, listed, known).digest != before.digest
    file.write_text(GOOD.replace("(1, 3", "(1, 4"))
    with pytest.raises(CampaignUnusable, match="start the run"):
        opened.simulated(campaign, listed, known)
    file.unlink()
    with pytest.raises(CampaignUnusable, match=rf"good\.py: {os.strerror(errno.ENOENT)}"):
        opened.simulated(campaign, listed, known)


def test_nothing_of_a_file_stays_in_this_process(folder: Path) -> None:
    (folder / "good.py").write_text(GOOD + "\nimport os\nos.environ['LEAKED'] = '1'\n")
    before = set(sys.modules)
    assert len(list(listed_files())) == 1
    assert "LEAKED" not in os.environ
    assert not [name for name in set(sys.modules) - before if "good" in name]
