"""What a process loads is not searched for cycles: while it loads, later, and when it ends; who starts one."""

from __future__ import annotations

import ast
import ctypes
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from campaigns import heap

ROOT = Path(__file__).parents[3]
SIMULATING = {f"worker/running/processes/{name}.py" for name in ("child", "live", "cases")}
"""They record the files of the code before any is loaded, then load the rest."""
STARTING = SIMULATING | {"backend/__main__.py", "clearance/__main__.py"}


@pytest.mark.parametrize("file", sorted(STARTING))
def test_what_starts_a_process_imports_it_before_anything_else(file: str) -> None:
    """After the files of the code are recorded, where they are, and the handler of an interrupt installed; it ends
    the interruption once all is imported."""
    tree = ast.parse((ROOT / file).read_text())
    imports = [n for n in tree.body if isinstance(n, (ast.Import, ast.ImportFrom))]
    names = [f"{getattr(n, 'module', '')} {n.names[0].name}" for n in imports if "__future__" not in ast.unparse(n)]
    first = ["worker.running.runs sources"] if file in SIMULATING else []
    first += ["clearance starting"] if file.startswith("clearance/") else []
    first += ["worker.running.processes blas"] if not file.startswith("backend/") else []
    assert names[: len(first) + 1] == [*first, "campaigns heap"]
    ends = [n.lineno for n in ast.walk(tree) if isinstance(n, ast.Expr) and ast.unparse(n) == "heap.loaded()"]
    assert len(ends) == 1
    assert ends[0] > max(n.lineno for n in imports)


def test_nothing_else_imports_what_changes_the_process() -> None:
    """Importing either changes the process: a program that imports `clearance` is not ours to change."""
    parts = ("backend", "campaigns", "clearance", "worker")
    texts = {f: f.read_text() for part in parts for f in (ROOT / part).rglob("*.py")}
    found = {
        file.relative_to(ROOT).as_posix()
        for file, text in texts.items()
        if re.search(
            r"^\s*(from|import) .*(campaigns(\.| import )heap|processes(\.| import )blas)\b", text, re.MULTILINE
        )
    }
    assert found == STARTING


PROGRAM = """
import gc
from campaigns import heap
import campaigns.asked.spec
while_loading = gc.isenabled()
ring = []; ring.append(ring); del ring
heap.loaded()
print(while_loading, gc.isenabled(), gc.get_threshold()[0], gc.get_freeze_count() > 10_000, gc.collect())
"""


def test_a_process_that_has_loaded_searches_only_what_comes_later() -> None:
    statement = subprocess.run(
        [sys.executable, "-c", PROGRAM], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout
    assert statement.split() == ["False", "True", str(heap.NEW), "True", "0"]


THREADS = """
import ctypes, sys, threading
from campaigns import heap
if sys.argv[1] == "shared":
    heap.shared()
libc, kept = ctypes.CDLL(None), []
libc.fopen.restype = ctypes.c_void_p
waiting = threading.Barrier(5)
def allocate():
    waiting.wait()
    kept.append([bytearray(n) for n in range(1_000, 20_000)])
    waiting.wait()
threads = [threading.Thread(target=allocate) for _ in range(4)]
[thread.start() for thread in threads]
waiting.wait(), waiting.wait()
file = ctypes.c_void_p(libc.fopen(sys.argv[2].encode(), b"w"))
libc.malloc_info(0, file), libc.fclose(file)
"""


@pytest.mark.nightly
@pytest.mark.skipif(not hasattr(ctypes.CDLL(None), "malloc_info"), reason="only glibc has arenas")
@pytest.mark.parametrize("memory", ["shared", pytest.param("as usual", marks=pytest.mark.nightly)])
def test_the_threads_of_a_service_share_one_arena(memory: str, tmp_path: Path) -> None:
    command = [sys.executable, "-c", THREADS, memory, str(tmp_path / "arenas.xml")]
    subprocess.run(command, cwd=ROOT, check=True, env={**os.environ, "PYTHONMALLOC": "malloc"})
    arenas = (tmp_path / "arenas.xml").read_text().count("<heap nr=")
    assert (arenas == 1) == (memory == "shared"), arenas
