"""A search method is one file: nothing else of the product names one, and a new file is all that a new one needs."""

from __future__ import annotations

import ast
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.faults.processes import REPOSITORY
from tests.given.case_campaigns import document
from worker.running.catalogue.installed import methods

ALLOWED = {
    # It repeats the published results, each with the method that the publication names.
    "worker/running/reproduce",
    # The search of a campaign that states none.
    "campaigns/limits.py",
    # A value of CSS.
    "frontend/src/launch/code/look.ts",
}
WALK = '''"""Corner walk: evaluates the corners of the box.

For this test, which counts what one file adds.
"""
from dataclasses import dataclass
import itertools
import numpy as np
from worker.engine.search.base import Method, MethodLook, Search, Space

@dataclass(frozen=True)
class Options:
    """It has none."""

def search(space: Space, options: Options) -> Search:
    yield np.array(list(itertools.product((0.0, 1.0), repeat=space.dimension)))
    return "evaluated every corner"

method = Method(
    name="corner_walk", title="Corner walk", kind="global", how="Global. Every corner", source="Clearance 2026",
    evaluations=64, options=Options, search=search, family="corners", whole_budget=True, parallel="all corners",
    suits="monotonic criteria", drawback="Others reach 0.9",
    look=MethodLook(colour="#123456", dark="#abcdef", marker="star"),
)
'''
ASK = """
import json, sys
from backend.catalog.looks import Looks
from backend.catalog.service import published
from backend.db import workers
from backend.db.engine import connect, read
from backend.db.tables import Base
from backend.scenes.base.palette import DARK, LIGHT
from campaigns import check
from campaigns.asked.load import load_document
from campaigns.checked.expected import expected
from tools.generated import FILES, PAGES
from worker.running.catalogue.installed import catalogue

document = json.loads(sys.argv[1])
engine = connect("sqlite:///catalogue.sqlite3")
Base.metadata.create_all(engine)
with engine.begin() as writer:
    workers.publish(writer, catalogue())
with read(engine) as reader:
    api = published(reader)
campaign = load_document(document)
look = Looks(api).method("corner_walk")
print(json.dumps({
    "api": api.method("corner_walk").model_dump(mode="json"),
    "problems": [str(problem) for problem in check(campaign, api)],
    "expected": next(stage for stage in expected(campaign, api) if stage.kind == "search"),
    "colours": [LIGHT.method(look), DARK.method(look)],
    "pages": PAGES["frontend/src/generated/methods.json"](),
    "guide": FILES["docs/methods.md"](),
}))
"""


def product() -> list[Path]:
    """The files of the product that may name a method."""
    found = [
        path
        for room in ("backend", "campaigns", "clearance", "worker", "frontend/src")
        for path in (REPOSITORY / room).rglob("*.*")
        if path.suffix in (".py", ".ts", ".tsx", ".css", ".j2")
    ]
    left = ("worker/engine/search", "frontend/src/client", "backend/db/migrations", *ALLOWED)
    names = [path.relative_to(REPOSITORY).as_posix() for path in found if ".test." not in path.name]
    return [REPOSITORY / name for name in names if not name.startswith(left)]


def named(path: Path) -> set[str]:
    """The methods that a file names: as a text, as a module that it imports, or by the variable of a colour."""
    text = path.read_text(encoding="utf-8")
    if not any(name in text for name in methods()):  # to parse all files takes seconds
        return set()
    if path.suffix == ".py":
        tree = list(ast.walk(ast.parse(text)))
        words = {node.value for node in tree if isinstance(node, ast.Constant) and isinstance(node.value, str)}
        modules = [n for n in tree if isinstance(n, ast.ImportFrom) and (n.module or "").endswith("search.methods")]
        words |= {alias.name for node in modules for alias in node.names}
    else:
        words = {a or b for a, b in re.findall(r"""['"`]([\w-]+)['"`]|--m-([\w-]+)""", text)}
    return words & methods().keys()


def test_no_other_file_of_the_product_names_a_method() -> None:
    files = product()
    assert len(files) > 500
    assert {str(path.relative_to(REPOSITORY)): found for path in files if (found := named(path))} == {}


def test_a_method_can_be_a_key() -> None:
    assert len(set(methods().values())) == len(methods())


@pytest.mark.parametrize("line", ['A = ("sqp",)', "from worker.engine.search.methods import sqp"])
def test_the_scan_sees_a_name(line: str, tmp_path: Path) -> None:
    (tmp_path / "a.py").write_text(line, encoding="utf-8")
    assert named(tmp_path / "a.py") == {"sqp"}


# By day a method of another package is found and has its colours: tests/unit/running/catalogue/test_catalog.py and
# tests/unit/campaigns/test_looks.py.
@pytest.mark.nightly
def test_one_file_is_in_catalogue_api_effort_colours_pages_and_guide(tmp_path: Path) -> None:
    source = tmp_path / "source"
    for folder in ("backend", "campaigns", "worker", "tools", "docs", "tests/bench/figures"):
        shutil.copytree(REPOSITORY / folder, source / folder)
    (source / "worker" / "engine" / "search" / "methods" / "corner_walk.py").write_text(WALK, encoding="utf-8")
    asked = document(stages__search=[{"method": "corner_walk", "evaluations": 40}])

    done = subprocess.run(
        [sys.executable, "-c", ASK, json.dumps(asked)], cwd=source, capture_output=True, text=True, check=False,
        env={**os.environ, "PYTHONPATH": str(source)},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["api"]["family"] == "corners"
    assert found["problems"] == []
    assert found["expected"] == ["search", "Search", 40, 40, 40], "its whole budget"
    assert found["colours"] == ["#123456", "#abcdef"]
    assert "corner_walk" in [method["name"] for method in json.loads(found["pages"])]
    aim = f"monotonic criteria. {found['api']['drawback']}"
    assert f"| Corner walk | `corner_walk` | Global. Every corner | {aim} | corners |" in found["guide"]
    assert any("`corner_walk`" in line for line in found["guide"].splitlines() if not line.startswith("|"))
