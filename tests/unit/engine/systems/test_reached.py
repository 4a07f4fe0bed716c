"""The digest of a function's file covers what the file imports, in every form of import, or states what it cannot."""

from __future__ import annotations

import importlib.machinery
import sys
from pathlib import Path

import pytest

from campaigns.identity.identity import UNREAD
from worker.engine.systems.simulators.declared import reached
from worker.engine.systems.simulators.declared.folder import digest_of_place, files_of_place, reached_from

ELSEWHERE = "import sys; sys.path.insert(0, {lib!r}); "
PARENT = "import sys\nfrom pathlib import Path\nHERE = Path(__file__).resolve().parent\n"
READ = {
    "import a": (ELSEWHERE + "import helper", "helper.py"),
    "import a as b": (ELSEWHERE + "import helper as h", "helper.py"),
    "from a import b": (ELSEWHERE + "from helper import X", "helper.py"),
    "from a import *": (ELSEWHERE + "from helper import *", "helper.py"),
    "a module of a package": (ELSEWHERE + "import pack.inner", "pack/inner.py"),
    "the package around it": (ELSEWHERE + "import pack.inner", "pack/__init__.py"),
    "from a package import a module": (ELSEWHERE + "from pack import inner", "pack/inner.py"),
    "from . import, in the package": (ELSEWHERE + "import pack.relative", "pack/inner.py"),
    "from .a import b, in the package": (ELSEWHERE + "import pack.relative", "pack/deep/last.py"),
    "from ..a import b, in the package": (ELSEWHERE + "import pack.deep.up", "pack/inner.py"),
    "of another file's import": (ELSEWHERE + "import outer", "helper.py"),
    "a folder without __init__": (ELSEWHERE + "import space.inside", "space/inside.py"),
    "inside a function": (ELSEWHERE + "\ndef f():\n    import helper\n", "helper.py"),
    "inside a class, a try and an if": (
        ELSEWHERE + "\nclass A:\n    try:\n        if 1:\n            import helper\n    except OSError:\n        ...",
        "helper.py",
    ),
    "importlib with a constant": (ELSEWHERE + "import importlib; importlib.import_module('helper')", "helper.py"),
    "import_module with a constant": (
        ELSEWHERE + "from importlib import import_module as im; im('pack.inner')",
        "pack/inner.py",
    ),
    "__import__ with a constant": (ELSEWHERE + "__import__('helper')", "helper.py"),
    "sys.path.append of a Path": (PARENT + "sys.path.append(str(HERE.parent / 'lib'))\nimport helper", "helper.py"),
    "sys.path += of os.path": (
        "import os, sys\nsys.path += [os.path.join(os.path.dirname(os.path.dirname(__file__)), 'lib')]\nimport helper",
        "helper.py",
    ),
    "sys.path[:0] =": (PARENT + "sys.path[:0] = [str(HERE.parents[0] / 'lib')]\nimport helper", "helper.py"),
    "sys.path = [..., *sys.path]": (
        PARENT + "sys.path = [str(HERE.parent / 'lib'), *sys.path]\nimport helper",
        "helper.py",
    ),
    "site.addsitedir": ("import site; site.addsitedir({lib!r}); import helper", "helper.py"),
    "a folder that another file adds": (ELSEWHERE + "import adds, further", "further/further.py"),
}
UNREADABLE = {
    "importlib with a variable": (
        "import importlib\nn = 'helper'\nimportlib.import_module(n)",
        "computed name, line 3",
    ),
    "importlib with an f-string": (
        "from importlib import import_module\nimport_module(f'{1}x')",
        "computed name, line 2",
    ),
    "importlib kept for later": ("import importlib\nf = importlib.import_module", "computed name, line 2"),
    "importlib by getattr": (
        "import importlib\ngetattr(importlib, 'import_module')('helper')",
        "computed name, line 2",
    ),
    "a relative constant": ("import importlib\nimportlib.import_module('.helper', 'x')", "computed name, line 2"),
    "__import__ with a variable": ("n = 'helper'\n__import__(n)", "computed name, line 2"),
    "exec": ("exec('import helper')", "code that exec executes, line 1"),
    "exec of builtins": ("import builtins\nbuiltins.exec(open('a').read())", "code that exec executes, line 2"),
    "eval": ("x = eval('1')", "code that eval executes, line 1"),
    "a file by its path": (
        "from importlib import util\nutil.spec_from_file_location('a', 'b')",
        "code that spec_from_file_location loads",
    ),
    "runpy": ("import runpy\nrunpy.run_path('x.py')", "code that run_path loads, line 2"),
    "a library of C": ("import ctypes\nctypes.CDLL('./fast.so')", "code that CDLL loads, line 2"),
    "a computed folder": (
        "import sys, os\nsys.path.append(os.environ['LIB'])",
        "a computed folder in sys.path, line 2",
    ),
    "of what it imports": (ELSEWHERE + "import dynamic", "computed name, line 2 of dynamic.py"),
    "an extension of one's own": (ELSEWHERE + "import fast", "the compiled module fast"),
}


@pytest.fixture
def place(tmp_path: Path) -> dict[str, str]:
    files = {
        "helper.py": "X = 1",
        "outer.py": "from helper import X",
        "adds.py": f"import sys; sys.path.append({str(tmp_path / 'lib' / 'further')!r})",
        "further/further.py": "X = 1",
        "dynamic.py": "import importlib\nimportlib.import_module(str(1))",
        "space/inside.py": "X = 1",
        "pack/__init__.py": "",
        "pack/inner.py": "X = 1",
        "pack/relative.py": "from . import inner\nfrom .deep.last import X",
        "pack/deep/__init__.py": "",
        "pack/deep/last.py": "X = 1",
        "pack/deep/up.py": "from ..inner import X",
        f"fast{importlib.machinery.EXTENSION_SUFFIXES[0]}": "",
    }
    for name, text in files.items():
        (tmp_path / "lib" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "lib" / name).write_text(text, encoding="utf-8")
    (tmp_path / "simulators").mkdir()
    return {"file": str(tmp_path / "simulators" / "fly.py"), "name": "fly"}


def write(place: dict[str, str], text: str) -> Path:
    lib = Path(place["file"]).parents[1] / "lib"
    Path(place["file"]).write_text(text.replace("{lib!r}", repr(str(lib))), encoding="utf-8")
    return lib


@pytest.mark.parametrize("form", READ)
def test_what_is_imported_from_another_folder_is_part_of_it(place: dict[str, str], form: str) -> None:
    text, edited = READ[form]
    lib = write(place, text)
    before = digest_of_place(place)
    assert not before.startswith(UNREAD), reached_from(place).unknown
    assert lib / edited in files_of_place(place)
    (lib / "unused.py").write_text("X = 1", encoding="utf-8")
    assert digest_of_place(place) == before
    (lib / edited).write_text("X = 2  # edited", encoding="utf-8")
    assert digest_of_place(place) != before


@pytest.mark.parametrize("form", UNREADABLE)
def test_what_cannot_be_read_is_named_and_identifies_nothing(place: dict[str, str], form: str) -> None:
    text, unknown = UNREADABLE[form]
    write(place, text)
    assert unknown in reached_from(place).unknown
    assert digest_of_place(place).startswith(UNREAD)


def test_a_circle_of_imports_ends(place: dict[str, str]) -> None:
    lib = write(place, ELSEWHERE + "import helper")
    (lib / "helper.py").write_text("import outer")
    assert {"helper", "outer"} <= reached_from(place).files.keys()


@pytest.mark.nightly
def test_installed_packages_count_by_name_and_version(
    place: dict[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    installed = tmp_path / "site-packages"
    write(place, "import guest.inner")
    for name, text in {
        "guest/__init__.py": "",
        "guest/inner.py": "X = 1",
        "the_guest-1.0.dist-info/top_level.txt": "guest",
    }.items():
        (installed / name).parent.mkdir(parents=True, exist_ok=True)
        (installed / name).write_text(text, encoding="utf-8")
    metadata = installed / "the_guest-1.0.dist-info/METADATA"
    metadata.write_text("Metadata-Version: 2.1\nName: the-guest\nVersion: 1.0\n")
    monkeypatch.setattr(sys, "path", [*sys.path, str(installed)])
    reached._distributions.cache_clear()
    before = digest_of_place(place)
    assert reached_from(place).packages == {"the-guest 1.0"}
    (installed / "guest/inner.py").write_text("X = 2")
    assert digest_of_place(place) == before, "an installed package is not read"
    metadata.write_text(metadata.read_text().replace("1.0", "1.1"))
    reached._distributions.cache_clear()
    assert digest_of_place(place) != before


def test_the_standard_library_and_clearance_are_not_files_of_ones_own(place: dict[str, str]) -> None:
    write(place, "import json, sys, ctypes, xml.dom\nfrom clearance import simulator\nctypes.CDLL(None)")
    found = reached_from(place)
    assert (found.files, found.packages, found.unknown) == ({}, set(), "")
