"""The dependency rules between packages, checked on the imports of all modules; every module has a docstring.

clearance -> worker -> backend.db -> campaigns; backend -> backend.db, campaigns. Start reading at `test_the_arrows`.
"""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[2]
OURS = ("backend", "campaigns", "clearance", "worker")

SHARED = ("backend.db", "backend.http", "backend.access", "campaigns")
"""What every feature of the service may import; other features only by name."""

# The project modules that a module may import besides its own package; the longest matching prefix applies.
MAY: dict[str, tuple[str, ...]] = {
    "campaigns": (),
    # Only `app`, `__main__` and `openapi` are loose, and they put the features together.
    "backend": ("campaigns",),
    "backend.settings": ("backend.db", "backend.webhooks.configured", "backend.provider.configured"),
    "backend.webhooks.configured": (),
    "backend.provider.configured": ("backend.db.roles",),
    "backend.db": ("campaigns",),
    "backend.http": ("backend.db", "campaigns"),
    "backend.middleware": ("backend.http",),
    "backend.access": ("backend.http", "backend.db"),
    "backend.health": ("backend.http",),
    "backend.sessions": SHARED,
    "backend.provider": (*SHARED, "backend.sessions"),
    "backend.users": SHARED,
    "backend.tokens": SHARED,
    "backend.trail": SHARED,
    "backend.catalog": SHARED,
    "backend.runs": (*SHARED, "backend.catalog"),
    "backend.workers": (*SHARED, "backend.runs"),
    "backend.drafts": (*SHARED, "backend.runs"),
    "backend.trends": (*SHARED, "backend.runs"),
    "backend.sweeps": (*SHARED, "backend.catalog", "backend.runs"),
    "backend.requirements": (*SHARED, "backend.catalog", "backend.runs"),
    "backend.webhooks": (*SHARED, "backend.runs"),
    "backend.signoffs": (*SHARED, "backend.runs"),
    "backend.results": (*SHARED, "backend.catalog", "backend.runs"),
    "backend.events": (*SHARED, "backend.catalog", "backend.runs", "backend.results", "backend.workers"),
    "backend.reports": (*SHARED, "backend.catalog", "backend.runs", "backend.results", "backend.signoffs"),
    "backend.previews": (*SHARED, "backend.catalog", "backend.scenes.live"),
    "backend.proposals": (*SHARED, "backend.catalog"),
    "backend.flights": (*SHARED, "backend.catalog", "backend.runs", "backend.results", "backend.scenes"),
    "backend.cases": (*SHARED, "backend.catalog", "backend.runs", "backend.scenes", "backend.flights"),
    "backend.exports": (
        *(*SHARED, "backend.catalog", "backend.runs", "backend.results", "backend.signoffs", "backend.reports"),
        *("backend.scenes.recordings", "backend.scenes.base"),
    ),
    "backend.scenes": (*SHARED, "backend.catalog", "backend.runs", "backend.results"),
    "backend.scenes.base": (*SHARED, "backend.catalog", "backend.runs", "backend.results"),
    "backend.scenes.live": ("backend.scenes.base", "campaigns.documents"),
    "backend.scenes.drawing": ("backend.scenes.base",),
    "worker.kernels": (),
    "worker.physics": ("worker.kernels",),
    # Entries of components follow below: none imports another kind.
    # How an evaluation ended has one home.
    "worker.search": ("campaigns.results.base",),
    "worker.catalogue": ("worker.kernels", "worker.search", "worker.components.own", "campaigns"),
    # In a process of its own, which the catalogue starts by its name.
    "worker.examination": (*("worker.kernels", "worker.components.own", "worker.systems.closed_loop.assemble"),),
    "worker.skeletons": ("worker.kernels",),
    # The interface: modules above it do not depend on the closed loop or any other system.
    "worker.systems": ("worker.search.base", "backend.db.records", "campaigns"),
    "worker.systems.closed_loop": (
        *("worker.systems.base", "worker.systems.threads", "worker.kernels", "worker.search", "worker.catalogue"),
        *("backend.db.records", "campaigns"),
    ),
    "worker.systems.simulators": (
        *("worker.systems.base", "worker.systems.threads", "worker.search.base"),
        *("worker.catalogue.simulator", "worker.catalogue.described", "worker.catalogue.descriptor"),
        *("worker.catalogue.function", "worker.catalogue.fmu", "worker.catalogue.folder", "worker.catalogue.columns"),
        "campaigns",
    ),
    # The slots know programs and JSON, nothing of campaigns.
    "worker.systems.simulators.slots": (),
    "worker.problem": ("worker.systems.base", "worker.systems.threads", "worker.search", "campaigns"),
    "worker.reference": ("worker.kernels", "worker.systems"),
    # It alone puts systems together, with what confirms them.
    "worker.opening": ("worker.problem", "worker.reference", "worker.systems", "worker.catalogue", "campaigns"),
    "worker.stages": (
        *("worker.problem", "worker.systems.base", "worker.search", "worker.catalogue"),
        *("backend.db.records", "campaigns"),
    ),
    "worker.verdicts": ("worker.stages", "worker.problem", "worker.systems.base", "campaigns"),
    "worker.runs": (
        *("worker.verdicts", "worker.stages", "worker.opening", "worker.problem", "worker.systems.base"),
        *("worker.search", "worker.catalogue", "worker.components.own", "worker.kernels.folder", "campaigns"),
    ),
    "worker.processes": (
        *("worker.runs", "worker.stages", "worker.opening", "worker.systems", "worker.catalogue"),
        *("backend.db", "campaigns"),
    ),
    "worker.audit": ("campaigns",),
    "worker.reproduce": (
        *("worker.runs", "worker.stages", "worker.opening", "worker.problem", "worker.systems"),
        *("worker.search", "worker.catalogue", "campaigns"),
    ),
    # The command line is on top: it may import every room, and no room may import it.
    "worker.cli": ("worker", "backend.db", "campaigns", "clearance.client"),
    # Where its process starts.
    "worker.__main__": ("worker.cli", "worker.processes.blas", "campaigns.heap"),
    # The same for programs in Python; it alone writes a report without a service.
    "clearance": ("worker", "campaigns"),
    # It talks to a service: nothing of ours but the vocabulary, so that a script starts quickly.
    "clearance.client": ("campaigns",),
    "clearance.saving": ("clearance.result", "worker", "backend.db", "backend.reports", "campaigns"),
}
KINDS = sorted(
    path.name for path in (REPOSITORY / "worker" / "components").iterdir() if (path / "__init__.py").exists()
)
MAY |= {f"worker.components.{kind}": ("worker.physics", "worker.kernels") for kind in KINDS}

# What a room never imports: others' modules, and inner ones of ours that a rule above would allow.
NEVER = {
    "backend": ("numba", "llvmlite", "nlopt", "worker"),
    "campaigns": ("numba", "llvmlite", "scipy", "sqlalchemy", "fastapi"),
    "worker": ("fastapi", "starlette", "uvicorn", "viser"),
    "worker.audit": ("numba", "llvmlite", "nlopt", "scipy", "SALib", "fastapi"),
    "worker.search.parts": ("worker.search.methods",),
    "worker.search.racing": ("worker.search.methods",),
}


def modules(*folders: str) -> list[Path]:
    return sorted(path for folder in folders for path in (REPOSITORY / folder).rglob("*.py"))


def name_of(path: Path) -> str:
    parts = path.relative_to(REPOSITORY).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def exists(name: str) -> bool:
    path = REPOSITORY.joinpath(*name.split("."))
    return path.with_suffix(".py").exists() or path.is_dir()


@cache
def imported(path: Path) -> frozenset[str]:
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
    return frozenset(found)


def within(name: str, prefixes: tuple[str, ...]) -> bool:
    return any(name == prefix or name.startswith(f"{prefix}.") for prefix in prefixes)


def rule(name: str) -> str:
    """The entry of `MAY` that applies to a module."""
    return max((prefix for prefix in MAY if within(name, (prefix,))), key=len, default="")


def folder_of(name: str) -> str:
    return name if REPOSITORY.joinpath(*name.split(".")).is_dir() else name.rpartition(".")[0]


def refused(name: str, others: Iterable[str]) -> list[str]:
    """A sentence for every import that the rules above do not allow to a module."""
    own = rule(name)
    found = []
    for other in sorted(others):
        if within(other, OURS) and not within(other, (own, *MAY.get(own, ()))):
            found.append(f"{name} imports {other}; {own or 'it'} may import {', '.join(MAY.get(own, ())) or 'nothing'}")
        if any(within(name, (part,)) and within(other, never) for part, never in NEVER.items()):
            found.append(f"{name} imports {other}, which is never allowed")
    return found


def circles(arrows: Mapping[str, Iterable[str]]) -> set[frozenset[str]]:
    """The groups of nodes of which each reaches every other."""

    def reached(start: str) -> frozenset[str]:
        seen: set[str] = set()
        waiting = [start]
        while waiting:
            fresh = set(arrows.get(waiting.pop(), ())) - seen
            seen |= fresh
            waiting += fresh
        return frozenset(seen)

    after = {node: reached(node) for node in arrows}
    return {
        frozenset(other for other in after[node] if node in after.get(other, ()))
        for node in arrows
        if node in after[node]
    }


def test_the_arrows() -> None:
    found = [line for path in modules(*OURS) for line in refused(name_of(path), imported(path))]
    assert not found, "\n" + "\n".join(found)


def test_every_room_has_a_rule() -> None:
    """A new package is not covered by another's rule; the worker has no modules outside its packages but its entry."""
    loose = [
        path.name for path in (REPOSITORY / "worker").glob("*.py") if path.name not in ("__init__.py", "__main__.py")
    ]
    loose += [path.name for path in (REPOSITORY / "worker" / "components").glob("*.py") if path.name != "__init__.py"]
    rooms = {name_of(path) for part in ("backend", "worker") for path in (REPOSITORY / part).glob("*/__init__.py")} - {
        "worker.components"
    }
    assert loose == []
    assert sorted(rooms - set(MAY)) == []
    assert sorted(name for name in MAY if not exists(name)) == []


APART = ("clearance.client", "worker.cli")
"""The lowest and the highest part of their packages: the client imports nothing of the rest, the command line all."""


def siblings(name: str, other: str) -> tuple[str, str]:
    """The sibling packages that contain two modules: `backend.runs` and `backend.db`, `worker` and `backend`."""
    part, beside = (next((whole for whole in APART if within(one, (whole,))), "") for one in (name, other))
    if part != beside and "clearance.client" in (part, beside):
        return part or name.split(".")[0], beside or other.split(".")[0]
    a, b = name.split("."), other.split(".")
    same = next((at for at, (one, two) in enumerate(zip(a, b, strict=False)) if one != two), min(len(a), len(b)))
    return ".".join(a[: same + 1]), ".".join(b[: same + 1])


def test_no_folder_imports_another_in_a_circle() -> None:
    """Without the doors (`__init__`) of folders, which lead to what is inside."""
    near: dict[str, dict[str, str]] = {}
    whole: dict[str, dict[str, str]] = {}
    for path in modules(*OURS):
        name = name_of(path)
        for other in imported(path) if path.name != "__init__.py" else ():
            if within(other, OURS):
                near.setdefault(folder_of(name), {})[folder_of(other)] = f"{name} imports {other}"
                room, beside = siblings(name, other)
                if folder_of(room) == room and folder_of(beside) == beside:
                    whole.setdefault(room, {})[beside] = f"{name} imports {other}"
    found = [
        line
        for arrows in (near, whole)
        for circle in circles(arrows)
        if len(circle) > 1
        for folder in sorted(circle)
        for other, line in sorted(arrows[folder].items())
        if other in circle and other != folder
    ]
    assert not found, "\n" + "\n".join(found)


def test_the_arrows_are_held() -> None:
    """The reading of imports sees what it is there to see, and the rules refuse what they are there to refuse."""
    here = imported(REPOSITORY / "backend" / "db" / "queue.py")
    assert {"backend.db.engine", "backend.db.tables", "campaigns.asked.spec", "sqlalchemy"} <= here
    for name, other in (
        ("worker.components.vehicles.unicycle", "worker.components.avoiders.apf"),
        ("worker.search.parts.descent", "worker.search.methods.sqp"),
        ("worker.search.base", "campaigns.results.search"),
        ("worker.problem.problem", "worker.kernels.layout"),
        ("worker.problem.problem", "worker.systems.closed_loop.system"),
        ("worker.stages.search", "worker.systems.closed_loop.trace"),
        ("worker.verdicts.sentence", "worker.kernels.layout"),
        ("worker.stages.search", "worker.runs.runner"),
        ("worker.stages.search", "worker.verdicts.verdict"),
        ("worker.runs.runner", "worker.processes.child"),
        ("worker.processes.child", "worker.cli.serve"),
        ("worker.runs.runner", "backend.app"),
        ("backend.catalog.service", "backend.runs.service"),
        ("backend.runs.service", "backend.settings"),
        ("backend.http.errors", "backend.runs.service"),
        ("backend.runs.service", "worker.stages"),
        ("backend.scenes.drawing.world", "backend.scenes.panel.tables"),
        ("backend.dbase", "numba"),
        ("campaigns.units", "backend.db.engine"),
        ("worker.runs.runner", "clearance.result"),
        ("clearance.result", "backend.reports.service"),
        ("clearance.client.calls", "clearance.result"),
        ("clearance.client.calls", "worker.catalogue.function"),
        ("worker.runs.runner", "clearance.client.calls"),
    ):
        assert refused(name, [other]), f"{name} may import {other}"
    assert refused("worker.processes.child", ["backend.db.queue", "worker.runs.runner", "numba", "campaigns"]) == []
    assert siblings("backend.runs.service", "backend.db.queue") == ("backend.runs", "backend.db")
    assert siblings("worker.runs.runner", "backend.db.queue") == ("worker", "backend")
    assert siblings("worker.cli.submit", "clearance.client.calls") == ("worker.cli", "clearance.client")
    assert siblings("clearance.client.calls", "clearance.result") == ("clearance.client", "clearance")
    assert circles({"a": ["b"], "b": ["c"], "c": ["b", "d"], "d": []}) == {frozenset("bc")}


def test_every_module_has_a_docstring() -> None:
    begins = re.compile(r'r?"""\s*[^\s"]')  # to parse all modules takes seconds
    silent = [
        str(path.relative_to(REPOSITORY))
        for path in modules(*OURS, "tests")
        if not begins.match(path.read_text(encoding="utf-8"))
    ]
    assert silent == []


Loads = list[tuple[str, set[str]]]
CLI = "from worker.cli import invoke; invoke(['--help']); invoke(['token', 'list', '--data', '/nowhere'])"
RUNNER = "import worker.runs.runner; from worker.catalogue.installed import catalogue; catalogue()"


@pytest.mark.parametrize(
    "chain",
    [
        [
            ("import gc, backend.__main__; assert gc.isenabled() and gc.get_freeze_count() > 100_000", set()),
            ("import backend.app", {"numba", "worker"}),
        ],
        # One after the other in one process: what is absent after several is absent after each alone.
        [
            ("import clearance", {"numpy", "numba", "scipy", "pydantic", "sqlalchemy", "fastapi"}),
            ("from clearance import Client", {"worker", "backend", "numpy", "numba", "scipy", "sqlalchemy", "fastapi"}),
            ("import campaigns", {"worker", "backend", "numpy", "numba", "scipy"}),
            (
                "import worker.audit.judge",
                {"numba", "scipy", "fastapi", "backend", "worker.runs.runner", "worker.catalogue.installed"},
            ),
            (CLI, {"numba", "scipy", "fastapi"}),
            ("import worker.processes.supervisor", {"numba", "scipy", "fastapi"}),
            (RUNNER, {"SALib", "scipy.linalg", "scipy.optimize", "scipy.special", "scipy.stats", "pymoo", "fastapi"}),
        ],
    ],
    ids=["service", "worker"],
)
def test_what_a_process_loads(chain: Loads) -> None:
    """Checked in a separate process, because imports are cached."""
    program = "import sys\n"
    for command, absent in chain:
        program += f"{command}\nloaded = set({sorted(absent)!r}) & set(sys.modules)\n"
        program += f"if loaded: sys.exit({command!r} + f' loads {{loaded}}')\n"
    program += "sys.exit('nothing else')"
    done = subprocess.run([sys.executable, "-c", program], cwd=REPOSITORY, capture_output=True, text=True, check=False)
    assert done.stderr.splitlines()[-1] == "nothing else", done.stderr


def test_no_module_of_tests_imports_another() -> None:
    # Shared helpers belong in modules without tests.
    found = [
        f"{path.name}: {line}"
        for path in (REPOSITORY / "tests").rglob("*.py")
        for line in path.read_text(encoding="utf-8").splitlines()
        if re.match(r"\s*(from tests[\w.]*\.test_\w+ import|import tests[\w.]*\.test_)", line)
    ]
    assert found == []
