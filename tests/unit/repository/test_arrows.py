"""The dependency rules between packages, checked on the imports of all modules; every module has a docstring.

clearance -> worker -> backend.db -> campaigns; backend -> backend.db, campaigns.
"""

from __future__ import annotations

import ast
import contextlib
import re
import subprocess
import sys
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[3]
OURS = ("backend", "campaigns", "clearance", "worker")

SHARED = ("backend.db", "backend.http", "backend.access", "campaigns")
"""What every feature of the service may import; other features only by name."""

ROOMS = ("engine", "evidence", "running")
"""Of the worker, by what an edit may change: a number, a claim, neither."""

BELOW_RUNS = ("worker.running.opening", "worker.running.catalogue", "campaigns")

# The project modules that a module may import besides its own package; the longest matching prefix applies.
MAY: dict[str, tuple[str, ...]] = {
    "campaigns": (),
    # Only `app`, `__main__` and `openapi` are loose, and they put the features together.
    "backend": ("campaigns",),
    "backend.settings": (
        *("backend.db", "backend.webhooks.configuration", "backend.provider.configuration", "backend.secret_settings"),
    ),
    "backend.secret_settings": (),
    "backend.webhooks.configuration": (),
    "backend.provider.configuration": ("backend.db.roles",),
    "backend.db": ("campaigns",),
    "backend.http": ("backend.db", "campaigns"),
    "backend.middleware": ("backend.http",),
    "backend.access": ("backend.http", "backend.db"),
    "backend.health": (*SHARED, "backend.reports.pdf"),
    "backend.metrics": (*SHARED, "backend.runs"),
    "backend.sessions": SHARED,
    "backend.provider": (*SHARED, "backend.sessions"),
    "backend.users": SHARED,
    "backend.tokens": SHARED,
    "backend.trail": SHARED,
    "backend.batch": SHARED,
    "backend.catalog": SHARED,
    "backend.runs": (*SHARED, "backend.catalog"),
    "backend.workers": (*SHARED, "backend.runs"),
    "backend.drafts": (*SHARED, "backend.runs"),
    "backend.trends": (*SHARED, "backend.runs"),
    "backend.sweeps": (*SHARED, "backend.catalog", "backend.runs"),
    "backend.requirements": (*SHARED, "backend.catalog", "backend.runs", "backend.signoffs"),
    "backend.webhooks": (*SHARED, "backend.runs"),
    "backend.signoffs": (*SHARED, "backend.catalog", "backend.runs"),
    "backend.results": (*SHARED, "backend.catalog", "backend.runs"),
    "backend.likelihood": (*SHARED, "backend.runs", "backend.results"),
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
    "backend.scenes.live": ("backend.scenes.base", "campaigns.stored.replies"),
    "backend.scenes.drawing": ("backend.scenes.base", "campaigns.looks"),
    # What may change a number. It knows nothing of what is installed, of claims, or of runs.
    "worker.engine.kernels": (),
    "worker.engine.physics": ("worker.engine.kernels",),
    # Entries of components follow below: none imports another kind.
    # How an evaluation ended has one home.
    # Compiled methods are stored as kernels are.
    "worker.engine.search": ("worker.engine.kernels.cached", "campaigns.results.base", "campaigns.effort"),
    # The probability of rare violations: like a search, it knows points and their costs.
    "worker.engine.rare": ("worker.engine.search.base", "campaigns.results.base"),
    # Regions of attraction: polynomials alone.
    "worker.engine.attraction": ("campaigns.certificates",),
    "worker.engine.search.racing.state": (
        *("worker.engine.search.base", "worker.engine.kernels.cached", "worker.engine.kernels.numba_internals"),
    ),
    # The interface: modules above it do not depend on the closed loop or any other system.
    "worker.engine.systems": ("worker.engine.search.base", "campaigns"),
    "worker.engine.systems.closed_loop": (
        *("worker.engine.systems.base", "worker.engine.systems.threads", "worker.engine.kernels"),
        *("worker.engine.search.base", "campaigns"),
    ),
    "worker.engine.systems.simulators": (
        *("worker.engine.systems.base", "worker.engine.systems.threads", "worker.engine.search.base", "campaigns"),
    ),
    "worker.engine.systems.simulators.declared": ("campaigns",),
    # The slots know programs and JSON, nothing of campaigns; what excludes a case is of the standard library alone.
    "worker.engine.systems.simulators.slots": ("worker.engine.systems.simulators.declared.excluded",),
    "worker.engine.problem": (
        *("worker.engine.systems.base", "worker.engine.systems.optional", "worker.engine.systems.threads"),
        *("worker.engine.search", "campaigns"),
    ),
    "worker.engine.reference": ("worker.engine.kernels", "worker.engine.systems"),
    "worker.engine.stages": (
        *("worker.engine.problem", "worker.engine.systems.base", "worker.engine.systems.optional"),
        *("worker.engine.search", "worker.engine.rare", "worker.engine.attraction", "campaigns"),
    ),
    # What may change a claim.
    "worker.evidence.scopes": ("worker.engine.systems", "campaigns"),
    "worker.evidence.verdicts": (
        *("worker.engine.stages", "worker.engine.problem", "worker.evidence.scopes", "campaigns"),
    ),
    "worker.evidence.restatement": (
        *("worker.evidence.verdicts", "worker.evidence.scopes", "worker.evidence.audit", "worker.engine.problem"),
        "campaigns",
    ),
    "worker.evidence.audit": ("campaigns", "backend.db.digest", "worker.engine.problem.distributions"),
    # What may change neither.
    "worker.running.catalogue": (
        *("worker.engine.kernels", "worker.engine.search", "worker.engine.components.own"),
        *("worker.engine.systems.simulators.declared", "worker.engine.systems.closed_loop.parts", "campaigns"),
    ),
    # In a process of its own, which the catalogue starts by its name.
    "worker.running.examination": (
        *(
            "campaigns.catalogue",
            "campaigns.checked.distances",
            "campaigns.checked.rates",
            "worker.engine.kernels",
            "worker.engine.components.own",
            "worker.engine.systems.closed_loop.assemble",
            "worker.engine.systems.closed_loop.distances",
        ),
        *("worker.engine.systems.simulators.declared.external", "worker.engine.systems.simulators.declared.outside"),
    ),
    "worker.running.skeletons": ("worker.engine.kernels",),
    # It alone puts systems together, with what confirms them.
    "worker.running.opening": (
        *("worker.engine.problem", "worker.engine.reference", "worker.engine.systems", "worker.running.catalogue"),
        "campaigns",
    ),
    "worker.running.runs": ("worker.engine", "worker.evidence", *BELOW_RUNS),
    "worker.running.processes": ("worker.running.runs", "worker.engine", *BELOW_RUNS, "backend.db"),
    "worker.running.reproduce": ("worker.running.runs", "worker.engine", *BELOW_RUNS),
    # A campaign run in this process, for the command line and for programs in Python.
    "clearance.local": ("worker", "backend.db", "campaigns"),
    # The command line is on top: it may import every room but the search of functions, and no room may import it.
    "clearance.cli": (
        *("worker", "backend.db", "backend.secret_settings", "campaigns", "clearance.client", "clearance.local"),
    ),
    # An installation is checked by the service's own checks.
    "clearance.cli.doctor": (
        *("clearance.cli", "backend.db", "backend.health.checks", "backend.settings", "worker.engine.kernels.folder"),
    ),
    # Where its process starts.
    "clearance.__main__": ("clearance.cli", "clearance.starting", "worker.running.processes.blas", "campaigns.heap"),
    "clearance.function": ("clearance.local", "worker", "campaigns"),
    # It alone writes a report without a service.
    "clearance.function.saving": (
        *("clearance.function", "clearance.local", "worker", "backend.db", "backend.reports", "campaigns"),
    ),
    # The contracts, for the tests of packages.
    "clearance.testing": ("worker", "campaigns"),
    # It talks to a service: nothing of ours but the vocabulary, so that a script starts quickly.
    "clearance.client": ("campaigns",),
    # The door of the package leads to all of them.
    "clearance": ("clearance", "worker.engine.systems.simulators.declared"),
}
KINDS = sorted(
    path.name for path in (REPOSITORY / "worker" / "engine" / "components").iterdir() if (path / "__init__.py").exists()
)
MAY |= {f"worker.engine.components.{kind}": ("worker.engine.physics", "worker.engine.kernels") for kind in KINDS}

# What a room never imports: others' modules, and inner ones of ours that a rule above would allow.
NEVER = {
    "backend": ("numba", "llvmlite", "nlopt", "worker"),
    "campaigns": ("numba", "llvmlite", "scipy", "sqlalchemy", "fastapi"),
    "worker": ("fastapi", "starlette", "uvicorn", "viser"),
    "worker.evidence.audit": ("numba", "llvmlite", "nlopt", "scipy", "SALib", "fastapi"),
    "worker.engine.search.parts": ("worker.engine.search.methods",),
    "worker.engine.search.racing": ("worker.engine.search.methods",),
}


def modules(*folders: str) -> list[Path]:
    return sorted(path for folder in folders for path in (REPOSITORY / folder).rglob("*.py"))


def name_of(path: Path) -> str:
    parts = path.relative_to(REPOSITORY).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def exists(name: str) -> bool:
    path = REPOSITORY.joinpath(*name.split("."))
    return path.with_suffix(".py").exists() or path.is_dir()


STATEMENTS = ast.stmt, ast.ExceptHandler, ast.match_case
"""What contains statements: no expression imports anything."""
IMPORT = re.compile(r"^[ \t]*((?:from [\w.]+ )?import (?:\([^)]*\)|[^\n(]+))", re.MULTILINE)
"""A statement that imports, as ruff formats it: on lines of its own."""


def statements(tree: ast.AST, types: bool) -> Iterator[ast.AST]:
    """All statements; without `types` those alone that can run."""
    for node in ast.iter_child_nodes(tree):
        skipped = not types and isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
        if isinstance(node, STATEMENTS) and not skipped:
            yield node
            yield from statements(node, types)


def importing(text: str, types: bool) -> Iterator[ast.AST]:
    """The statements of a module, or those alone that import: to parse all modules takes seconds."""
    if types or "TYPE_CHECKING" not in text:
        with contextlib.suppress(SyntaxError):  # a line of a text, or a parenthesis in a comment
            return iter(ast.parse("\n".join(IMPORT.findall(text))).body)
    return statements(ast.parse(text), types)


@cache
def imported(path: Path, types: bool = True) -> frozenset[str]:
    """Every module that a file imports, wherever in it; `from a import b` is `a.b` where that is a module.

    types: also those whose types alone it names.
    """
    text = path.read_text(encoding="utf-8")
    if not types and "TYPE_CHECKING" not in text:
        return imported(path)
    found: set[str] = set()
    package = name_of(path).split(".") if path.name == "__init__.py" else name_of(path).split(".")[:-1]
    for node in importing(text, types):
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
    left = set(arrows)  # without those from which every way ends: most of them
    while ends := {node for node in left if left.isdisjoint(arrows[node])}:
        left -= ends

    def reached(start: str) -> frozenset[str]:
        seen: set[str] = set()
        waiting = [start]
        while waiting:
            fresh = left.intersection(arrows[waiting.pop()]) - seen
            seen |= fresh
            waiting += fresh
        return frozenset(seen)

    after = {node: reached(node) for node in left}
    return {frozenset(other for other in after[node] if node in after[other]) for node in left if node in after[node]}


def test_imports_follow_the_arrows() -> None:
    found = [line for path in modules(*OURS) for line in refused(name_of(path), imported(path))]
    assert not found, "\n" + "\n".join(found)


def test_every_room_has_a_rule() -> None:
    """A new package is not covered by another's rule; the worker has no modules outside its packages."""
    loose = [
        str(path.relative_to(REPOSITORY))
        for folder in ("worker", *(f"worker/{room}" for room in ROOMS), "worker/engine/components")
        for path in (REPOSITORY / folder).glob("*.py")
        if path.name != "__init__.py"
    ]
    packages = {
        name_of(p)
        for place in ("backend/*", "worker/*/*", "clearance/*")
        for p in REPOSITORY.glob(f"{place}/__init__.py")
    }
    rooms = packages - {"worker.engine.components"}
    assert loose == []
    assert sorted(rooms - set(MAY)) == []
    assert sorted(name for name in MAY if not exists(name)) == []


def siblings(name: str, other: str) -> tuple[str, str]:
    """The sibling packages that contain two modules: `backend.runs` and `backend.db`, `worker` and `backend`."""
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


def test_no_file_imports_another_in_a_circle() -> None:
    """Neither where it is loaded nor later, within a function."""
    arrows = {name_of(path): imported(path, types=False) for path in modules(*OURS)}
    found = {circle for circle in circles(arrows) if len(circle) > 1}
    assert not found, "\n".join(map(str, map(sorted, found)))


def test_nothing_that_can_change_a_number_imports_the_rules_of_a_claim() -> None:
    """Not through other modules either: another limit of a verdict is no other code of a run."""
    files = {name_of(path): path for path in modules("worker", "campaigns", "backend/db")}
    waiting = [name for name in files if name.startswith("worker.engine")]
    seen: set[str] = set(waiting)
    while waiting:
        name = waiting.pop()
        others = imported(files[name]) | {name.rpartition(".")[0]}  # a package runs before what is in it
        fresh = {other for other in others if other in files} - seen
        seen |= fresh
        waiting += fresh
    assert "campaigns.limits" in seen
    assert "campaigns.rules" not in seen


def test_the_arrows_are_held() -> None:
    """The reading of imports sees what it is there to see, and the rules refuse what they are there to refuse."""
    here = imported(REPOSITORY / "backend" / "db" / "queue.py")
    assert {"backend.db.engine", "backend.db.tables", "campaigns.asked.spec", "sqlalchemy"} <= here
    for name, other in (
        ("worker.engine.components.vehicles.unicycle", "worker.engine.components.avoiders.apf"),
        ("worker.engine.search.parts.descent", "worker.engine.search.methods.sqp"),
        ("worker.engine.search.base", "campaigns.results.search"),
        ("worker.engine.problem.problem", "worker.engine.kernels.layout"),
        ("worker.engine.problem.problem", "worker.engine.systems.closed_loop.system"),
        ("worker.engine.stages.search", "worker.engine.systems.closed_loop.trace"),
        ("worker.evidence.verdicts.sentence", "worker.engine.kernels.layout"),
        ("worker.engine.stages.search", "worker.running.runs.runner"),
        ("worker.engine.stages.search", "worker.evidence.verdicts.verdict"),
        ("worker.running.runs.runner", "worker.running.processes.child"),
        ("worker.running.processes.child", "clearance.cli.serve"),
        ("worker.running.runs.runner", "backend.app"),
        ("worker.engine.stages.search", "worker.running.catalogue.installed"),
        ("worker.engine.systems.base", "backend.db.rows"),
        ("worker.evidence.verdicts.verdict", "worker.running.runs.runner"),
        ("clearance.function.running", "clearance.cli.run"),
        ("backend.catalog.service", "backend.runs.service"),
        ("backend.runs.service", "backend.settings"),
        ("backend.http.errors", "backend.runs.service"),
        ("backend.runs.service", "worker.engine.stages"),
        ("backend.scenes.drawing.world", "backend.scenes.panel.tables"),
        ("backend.dbase", "numba"),
        ("campaigns.units", "backend.db.engine"),
        ("worker.running.runs.runner", "clearance.function.result"),
        ("clearance.function.result", "backend.reports.service"),
        ("clearance.client.calls", "clearance.function.result"),
        ("clearance.client.calls", "worker.engine.systems.simulators.declared.function"),
        ("worker.running.runs.runner", "clearance.client.calls"),
    ):
        assert refused(name, [other]), f"{name} may import {other}"
    allowed = ["backend.db.queue", "worker.running.runs.runner", "numba", "campaigns"]
    assert refused("worker.running.processes.child", allowed) == []
    assert siblings("backend.runs.service", "backend.db.queue") == ("backend.runs", "backend.db")
    assert siblings("worker.running.runs.runner", "backend.db.queue") == ("worker", "backend")
    assert siblings("clearance.cli.submit", "clearance.client.calls") == ("clearance.cli", "clearance.client")
    assert siblings("clearance.client.calls", "clearance.function.result") == ("clearance.client", "clearance.function")
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
HELP = "from clearance.cli import invoke; invoke(['--help'])"
CLI = "from clearance.cli import invoke; invoke(['--help']); invoke(['token', 'list', '--data', '/nowhere'])"
HEAVY = {"SALib", "clarabel", "scipy.linalg", "scipy.optimize", "scipy.special", "scipy.stats", "fastapi"}
STAGES = "from worker.engine.stages.found import stages; stages()"
RUNNER = "import worker.running.runs.runner; from worker.running.catalogue.installed import catalogue; catalogue()"


@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    "chain",
    [
        [
            ("import backend.requirements.reading, backend.requirements.table", {"numpy", "pydantic", "sqlalchemy"}),
            ("import gc, backend.__main__; assert gc.isenabled() and gc.get_freeze_count() > 100_000", set()),
            ("import backend.app", {"numba", "worker", "scipy", "alembic"}),
        ],
        # One after the other in one process: what is absent after several is absent after each alone.
        [
            ("import clearance", {"numpy", "numba", "scipy", "pydantic", "sqlalchemy", "fastapi"}),
            ("import campaigns.stages.found", {"worker", "backend", "numpy", "numba", "scipy"}),
            ("from clearance import Client", {"worker", "backend", "numpy", "numba", "scipy", "sqlalchemy", "fastapi"}),
            ("from campaigns import Campaign, Catalogue, check", {"worker", "backend", "numpy", "numba", "scipy"}),
            (
                "import worker.evidence.audit.judge",
                {
                    "numba",
                    "scipy",
                    "fastapi",
                    "backend",
                    "worker.running.runs.runner",
                    "worker.running.catalogue.installed",
                },
            ),
            (HELP, {"numba", "scipy", "fastapi", "backend.db.tables"}),
            (CLI, {"numba", "scipy", "fastapi"}),
            ("import worker.running.processes.supervisor", {"numba", "scipy", "fastapi"}),
            (
                RUNNER,
                {"SALib", "clarabel", "scipy.linalg", "scipy.optimize", "scipy.special", "scipy.stats", "fastapi"},
            ),
            (
                STAGES,
                {"SALib", "clarabel", "scipy.linalg", "scipy.optimize", "scipy.special", "scipy.stats", "fastapi"},
            ),
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
