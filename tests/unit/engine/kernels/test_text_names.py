"""Names in the generated text of components, and components of other packages: no stale results."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import textwrap
import types
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.given.assembled_loops import check, parts, vector
from worker.engine.kernels.text.names import Names, UnnamedError
from worker.engine.kernels.text.written import written
from worker.engine.systems.closed_loop.assemble import Loop

# Names


POST = """
from typing import Annotated, NamedTuple
from worker.engine.kernels.component import Obstacle, Parameter
from worker.engine.kernels.maths import kernel, norm2
from worker.engine.kernels.views import Body

class Post(NamedTuple):
    x: Annotated[float, Parameter("m", "Position, x")] = 4.0
    y: Annotated[float, Parameter("m", "Position, y")] = 4.0

@kernel
def body(t, o, q, p):
    d = norm2(q[0] - p.x, q[1] - p.y)
    return Body(p.x, p.y, 0.0, 0.0, RADIUS, d - RADIUS, (q[0] - p.x) / d, (q[1] - p.y) / d)

component = Obstacle(name="post", title="Post", dimension=2, parameters=Post, body=body)
"""


@pytest.fixture
def module(monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """A module from its text, as an import would make it."""

    def made(name: str, text: str) -> types.ModuleType:
        package, _, last = name.rpartition(".")
        found = types.ModuleType(name)
        exec(compile(text, f"{name}.py", "exec", dont_inherit=True), vars(found))
        monkeypatch.setitem(sys.modules, name, found)
        if package:
            home = sys.modules.get(package) or types.ModuleType(package)
            monkeypatch.setitem(sys.modules, package, home)
            setattr(home, last, found)
        return found

    return made


def test_two_modules_of_one_name(module: Any) -> None:
    near = module("some_near.post", "RADIUS = 0.5\n" + POST)
    far = module("some_far.post", "RADIUS = 1.5\n" + POST)
    loop = Loop(parts(obstacles=(near.component, far.component)), lanes=1, compiled=False)
    assert "from some_near import post\n" in loop.text
    assert "from some_far import post as some_far_post\n" in loop.text
    check(loop.text)
    seen = loop.part("bodies")(0.0, (), (0.0, 0.0), loop.extend(vector(loop)))
    assert [b.radius for b in seen] == [0.5, 1.5]


@pytest.mark.parametrize("name", ["goal", "obstacle_0", "xv", "closed_loop", "views"])
def test_a_module_named_like_something_of_the_text(name: str, module: Any) -> None:
    loop = Loop(parts(obstacles=(module(name, "RADIUS = 0.5\n" + POST).component,)), lanes=1, compiled=False)
    check(loop.text)
    assert loop.part("bodies")(0.0, (), (0.0, 0.0), loop.extend(vector(loop)))[0].radius == 0.5


def test_modules_have_distinct_names() -> None:
    names = Names(frozenset({"goal"}))
    given = ("a.b", "c.b", "c_b", "goal", "a.goal", "x.c_b", "c.b")
    assert len({names.module(full) for full in given}) == len(set(given))
    assert names.imports()[:3] == ["from a import b", "from a import goal as a_goal", "from c import b as c_b"]


def test_kernels_may_be_defined_in_a_helper(module: Any) -> None:
    helper = module("some_helper", "RADIUS = 0.25\n" + POST)
    own = module("some_post", "from some_helper import component")
    text = written(parts(obstacles=(own.component,)))
    assert "import some_helper\n" in text
    assert "body_0 = some_helper.body(t, (), q, obstacle_0)" in text
    assert helper.component is own.component


def test_a_component_made_by_a_function_is_refused(module: Any) -> None:
    indented = textwrap.indent(POST, "    ")
    made = module("some_made", f"def made():\n    RADIUS = 0.5\n{indented}\n    return component\ncomponent = made()\n")
    with pytest.raises(UnnamedError, match=r"obstacle 'post': 'body' .* some_made;"):
        Loop(parts(obstacles=(made.component,)))


# Components of other packages: no stale results


FAR = """
from worker.engine.kernels.maths import kernel

@kernel
def grown(radius):
    return radius + 0.25
"""

NEAR = """
from worker.engine.kernels.maths import kernel
import some_package.far as far

@kernel
def beyond(radius):
    return far.grown(radius)
"""

FLIES = """
import json
from some_package import post
from tests.given.assembled_loops import parts, vector
from worker.engine.systems.closed_loop.assemble import Loop

loop = Loop(parts(obstacles=(post.component,)))
flown = loop.simulate(vector(loop)[None], 0.005, 800)
stats = loop._fly.stats
print(json.dumps({"digest": loop.digest, "cost": flown.costs[0, 0], "hits": sum(stats.cache_hits.values())}))
"""


@pytest.mark.nightly  # by day tests/unit/engine/kernels/test_bind.py edits a helper of a small kernel
def test_an_edit_two_imports_away_gives_a_new_answer(tmp_path: Path) -> None:
    package = tmp_path / "some_package"
    package.mkdir()
    own = POST.replace("RADIUS", "near.beyond(0.5)").replace(
        "from typing", "import some_package.near as near\nfrom typing", 1
    )
    for name, text in {"__init__": "", "far": FAR, "near": NEAR, "post": own}.items():
        (package / f"{name}.py").write_text(text, encoding="utf-8")

    def flown() -> Any:
        place = {
            "CLEARANCE_KERNEL_CACHE": str(tmp_path / "cache"),
            "PYTHONPATH": os.pathsep.join([str(tmp_path), os.getcwd()]),
            "PYTHONDONTWRITEBYTECODE": "1",  # edits come faster than the clock of a file system
        }
        environment = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"} | place
        done = subprocess.run(
            [sys.executable, "-c", FLIES], env=environment, capture_output=True, text=True, timeout=240, check=False
        )
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    first = flown()
    assert first["hits"] == 0
    (package / "far.py").write_text(FAR + "\n# A comment.\n", encoding="utf-8")
    assert flown() == first | {"hits": 1}
    (package / "far.py").write_text(FAR.replace("+ 0.25", "+ 0.75"), encoding="utf-8")
    edited = flown()
    assert edited["hits"] == 0
    assert edited["digest"] != first["digest"]
    assert abs(edited["cost"] - first["cost"]) > 1e-3
