"""The arrows between the parts, read from the imports of every module; and that every module says what it is.

worker -> backend.db -> campaigns; backend -> backend.db, campaigns. Start reading at `test_arrow`.
"""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[2]
OURS = ("backend", "campaigns", "worker")

# What a module may import of ours, by the longest prefix of its own name that is listed.
MAY = {
    "campaigns": ("campaigns",),
    "backend.db": ("backend.db", "campaigns"),
    "backend": ("backend", "campaigns"),
    "worker": ("worker", "backend.db", "campaigns"),
    "worker.kernels": ("worker.kernels",),
    "worker.physics": ("worker.physics", "worker.kernels"),
    "worker.search": ("worker.search",),
    "worker.audit": ("worker.audit", "campaigns"),
    "worker.components": ("worker.components", "worker.physics", "worker.kernels"),
}
# What it may not import of others': the service and the vocabulary never load a compiler.
NEVER = {
    "backend": ("numba", "llvmlite", "nlopt", "worker"),
    "campaigns": ("numba", "llvmlite", "numpy", "scipy", "sqlalchemy", "fastapi"),
    "worker": ("fastapi", "starlette", "uvicorn", "viser"),
    "worker.audit": ("numba", "llvmlite", "nlopt", "scipy", "SALib", "fastapi"),
}


def modules(*folders: str) -> list[Path]:
    return sorted(path for folder in folders for path in (REPOSITORY / folder).rglob("*.py"))


def name_of(path: Path) -> str:
    parts = path.relative_to(REPOSITORY).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def exists(name: str) -> bool:
    path = REPOSITORY.joinpath(*name.split("."))
    return path.with_suffix(".py").exists() or path.is_dir()


def imported(path: Path) -> set[str]:
    """Every module that a file imports, wherever in it; `from a import b` is `a.b` where that is a module."""
    found: set[str] = set()
    package = name_of(path).split(".") if path.name == "__init__.py" else name_of(path).split(".")[:-1]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            origin = ".".join([*base, *([node.module] if node.module else [])])
            for alias in node.names:
                whole = f"{origin}.{alias.name}"
                found.add(whole if origin.split(".")[0] in OURS and exists(whole) else origin)
    return found


def within(name: str, prefixes: tuple[str, ...]) -> bool:
    return any(name == prefix or name.startswith(f"{prefix}.") for prefix in prefixes)


def allowed(name: str) -> tuple[str, ...]:
    return MAY[max((prefix for prefix in MAY if within(name, (prefix,))), key=len)]


@pytest.mark.parametrize("path", modules(*OURS), ids=name_of)
def test_arrow(path: Path) -> None:
    name = name_of(path)
    for other in imported(path):
        if within(other, OURS):
            assert within(other, allowed(name)), f"{name} imports {other}, may import {' and '.join(allowed(name))}"
        for part, never in NEVER.items():
            assert not (within(name, (part,)) and within(other, never)), f"{name} imports {other}"


def test_the_arrows_are_held() -> None:
    """The reading of imports sees what it is there to see."""
    here = imported(REPOSITORY / "backend" / "db" / "queue.py")
    assert {"backend.db.engine", "backend.db.tables", "campaigns.asked.spec", "sqlalchemy"} <= here
    assert allowed("worker.components.vehicles.unicycle") == ("worker.components", "worker.physics", "worker.kernels")
    assert allowed("worker.runs.runner") == ("worker", "backend.db", "campaigns")
    assert not within("backend.dbase", ("backend.db",))


@pytest.mark.parametrize("path", modules(*OURS, "tests"), ids=name_of)
def test_every_module_says_what_it_is(path: Path) -> None:
    docstring = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8")))
    assert docstring, f"{path.relative_to(REPOSITORY)} has no docstring"


@pytest.mark.parametrize(
    ("command", "absent"),
    [
        ("import backend.app", {"numba", "worker"}),
        ("from worker.cli import invoke; invoke(['--help'])", {"numba", "scipy", "fastapi"}),
        (
            "from worker.cli import invoke; invoke(['token', 'list', '--data', '/nowhere'])",
            {"numba", "scipy", "fastapi"},
        ),
        ("import worker.processes.supervisor", {"numba", "scipy", "fastapi"}),
        (
            "import worker.audit.judge",
            {"numba", "scipy", "fastapi", "backend", "worker.runs.runner", "worker.catalogue.installed"},
        ),
    ],
)
def test_what_a_process_loads(command: str, absent: set[str]) -> None:
    """Seen in a process of its own, since what one module imports another imports too."""
    program = f"import sys\n{command}\nsys.exit(str(set({sorted(absent)!r}) & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", program], cwd=REPOSITORY, capture_output=True, text=True, check=False)
    assert done.stderr.splitlines()[-1] == "set()", done.stderr
