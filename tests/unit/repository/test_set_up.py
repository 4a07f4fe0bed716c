"""Which interpreter `make install` takes: the first that suits, or the same version in one piece."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[3]
VERSION = f"python{sys.version_info.major}.{sys.version_info.minor}"


def interpreter(file: Path, piece: bool, suits: bool = True) -> str:
    """This interpreter, which answers what the script asks of it as given."""
    file.parent.mkdir(exist_ok=True)
    file.write_text(
        "#!/bin/sh\n"
        f"case \"$2\" in *libpython*) exit {int(not piece)};; *'not (3, 11)'*) exit {int(not suits)};; esac\n"
        f'exec "{sys.executable}" "$@"\n'
    )
    file.chmod(0o755)
    return str(file)


def found(folder: Path, **environment: str) -> str:
    script = f"source tools/common.sh; source tools/python.sh; system=({folder}/none {folder}/system); find_python"
    path = f"{folder}/first:{os.environ['PATH']}"
    known = {name: value for name, value in os.environ.items() if name != "PYTHON"}  # make hands on what it was given
    done = subprocess.run(
        ["bash", "-c", script],
        cwd=REPOSITORY,
        env=known | {"PATH": path} | environment,
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.strip()


@pytest.mark.parametrize(
    ("first", "system", "taken"),
    [(False, True, "system"), (True, True, "first"), (False, False, "first"), (True, False, "first")],
)
def test_of_one_version_the_one_in_one_piece_is_taken(tmp_path: Path, first: bool, system: bool, taken: str) -> None:
    found_at = {
        "first": interpreter(tmp_path / "first" / "python3", first),
        "system": interpreter(tmp_path / "system" / VERSION, system),
    }
    assert found(tmp_path) == found_at[taken]


def test_one_that_is_named_is_taken_as_it_is(tmp_path: Path) -> None:
    named = interpreter(tmp_path / "first" / "python3", piece=False)
    interpreter(tmp_path / "system" / VERSION, piece=True)
    assert found(tmp_path, PYTHON=named) == named


def test_another_version_is_not_taken(tmp_path: Path) -> None:
    first = interpreter(tmp_path / "first" / "python3", piece=False)
    interpreter(tmp_path / "system" / "python3.99", piece=True)
    assert found(tmp_path) == first


def test_one_that_does_not_suit_is_passed_over(tmp_path: Path) -> None:
    interpreter(tmp_path / "first" / "python3", piece=True, suits=False)
    other = interpreter(tmp_path / "first" / "python3.13", piece=True)
    interpreter(tmp_path / "first" / "python3.14", piece=True, suits=False)
    assert found(tmp_path) == other
