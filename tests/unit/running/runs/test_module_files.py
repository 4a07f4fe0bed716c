"""What a process loads after it has taken the digest of its code is what the digest covers, whatever the files have."""

from __future__ import annotations

import importlib
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from worker.running.runs import module_files, sources
from worker.running.runs.module_files import File, Recorded, mark

NEEDED = {"worker.engine.reference.flight", "worker.engine.reference.compiled", "worker.engine.attraction.region"}
"""Some of those that a run loads late."""

START = """
import importlib, json, sys
from worker.running.runs import sources
from worker.running.catalogue.installed import catalogue
from worker.running.runs import identity, runner
catalogue(), identity.code_parts()
early, files = set(sys.modules), sources.LOADED.recorded
for name, file in files.items():  # as if each file had been edited since it was recorded
    if name not in early and file.path.endswith(".py"):
        files[name] = file._replace(mark=None, content=file.content + b"\\nRECORDED = True\\n")
"""
END = """
late = [name for name in files if name in sys.modules and name not in early]
print(json.dumps([late, [name for name in late if not hasattr(sys.modules[name], "RECORDED")]]))
"""
IMPORT = """
for name in identity.installation().modules:
    try:
        importlib.import_module(name)
    except ModuleNotFoundError as missing:  # of an optional package
        assert not missing.name.startswith(("worker", "campaigns")), missing
"""
RUN = """
from campaigns import library, load_file
from campaigns.asked.load import load_document
from campaigns.stages.found import declared
from worker.running.runs.store import MemoryStore
document = load_file(library()["pioneer_no_avoidance"]).document()
document["stages"] = {
    "sensitivity": {"points": 3, "morris": {"trajectories": 4}, "sobol": {"samples": 8}},
    "search": [{"method": "direct", "evaluations": 20}, {"method": "monte_carlo", "evaluations": 20}],
    "certify": {"samples": 5, "grid": {"points": 2}},
    "estimate": {"evaluations": 1000},
    "attraction": {"degree": 2},
    "validate": {"neighbours": 2, "evaluations": 10},
}
case = {"label": "F1", "parameters": {"vehicle.m": 10.0}, "cost": 0.94}
document["baseline"] = {"run": "R-0001", "digest": "0" * 64, "threshold": 0.5, "cases": [case]}
document["scenario"]["horizon"] = 2.0
store = MemoryStore()
runner.execute(load_document(document), store, threads=1)
assert {record.plan.kind for record in store.stages} == declared().keys()
"""


def loaded_late(program: str) -> tuple[set[str], list[str]]:
    """The modules that a program loads after the digest was taken, and those of them that are not as recorded."""
    command = [sys.executable, "-c", START + program + END]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    late, others = json.loads(done.stdout.splitlines()[-1])
    return set(late), others


@pytest.mark.nightly
def test_every_module_of_the_digest_that_is_loaded_late_is_the_recorded_one() -> None:
    late, others = loaded_late(IMPORT)
    assert late >= NEEDED
    assert others == []


@pytest.mark.nightly  # by day all modules that such a run may load
def test_a_run_of_every_kind_of_stage_loads_what_was_recorded() -> None:
    late, others = loaded_late(RUN)
    assert late >= NEEDED
    assert others == []


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A recorded package of two modules, none of them loaded yet."""
    place = tmp_path / "recorded_here"
    place.mkdir()
    files = {"recorded_here": place / "__init__.py", "recorded_here.inner": place / "inner.py"}
    for file in files.values():
        file.write_text("X = 1.0\n", encoding="utf-8")
    known = {name: File(str(file), mark(str(file)), file.read_bytes()) for name, file in files.items()}
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(sys, "meta_path", [Recorded(known), *sys.meta_path])
    for name in files:
        monkeypatch.delitem(sys.modules, name, raising=False)
    importlib.invalidate_caches()
    return place


def test_a_file_that_is_edited_or_deleted_is_loaded_as_it_was(package: Path) -> None:
    (package / "__init__.py").write_text("X = 2.0\n", encoding="utf-8")
    (package / "inner.py").unlink()
    outer, inner = importlib.import_module("recorded_here"), importlib.import_module("recorded_here.inner")
    assert (outer.X, inner.X) == (1.0, 1.0)
    assert inner.__file__ == str(package / "inner.py")
    assert importlib.reload(outer).X == 2.0, "which a user asked for"


def test_a_package_in_the_place_of_a_module_is_not_loaded_nor_a_folder_without_its_file(package: Path) -> None:
    (package / "inner.py").unlink()
    (package / "inner").mkdir()
    (package / "inner" / "__init__.py").write_text("X = 2.0\n", encoding="utf-8")
    (package / "__init__.py").unlink()
    assert importlib.import_module("recorded_here").X == 1.0
    assert importlib.import_module("recorded_here.inner").X == 1.0


def test_an_edit_while_it_is_loaded_is_not_loaded(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file, marked = package / "__init__.py", module_files.mark

    def edited(path: str) -> module_files.Mark | None:
        found = marked(path)
        file.write_text("X = 2.0\n", encoding="utf-8")
        return found

    monkeypatch.setattr(module_files, "mark", edited)
    assert importlib.import_module("recorded_here").X == 1.0


def test_an_unchanged_file_is_loaded_with_its_bytecode(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    monkeypatch.setattr(sys, "pycache_prefix", None)
    assert importlib.import_module("recorded_here.inner").X == 1.0
    assert list((package / "__pycache__").iterdir())


def test_a_compiled_module_that_has_changed_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    name = f"compiled_here{importlib.machinery.EXTENSION_SUFFIXES[-1]}"
    file = tmp_path / name
    file.write_bytes(b"one")
    finder = Recorded({"compiled_here": File(str(file), mark(str(file)), b"one")})
    monkeypatch.syspath_prepend(str(tmp_path))
    importlib.invalidate_caches()
    assert finder.find_spec("compiled_here") is not None
    os.utime(file)
    assert finder.find_spec("compiled_here") is not None
    file.write_bytes(b"other")
    with pytest.raises(ImportError, match=name):
        finder.find_spec("compiled_here")


def test_a_module_of_the_same_name_that_comes_first_is_not_replaced(
    package: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    other = tmp_path / "first" / "recorded_here.py"
    other.parent.mkdir()
    other.write_text("X = 3.0\n", encoding="utf-8")
    monkeypatch.syspath_prepend(str(other.parent))
    assert importlib.import_module("recorded_here").X == 3.0
    assert any(isinstance(finder, Recorded) for finder in sys.meta_path)


def test_the_modules_of_the_digest_are_found_so() -> None:
    assert sources.LOADED.recorded.keys() == sources.LOADED.files.keys()
    assert any(isinstance(each, Recorded) and each.files is sources.LOADED.recorded for each in sys.meta_path)
