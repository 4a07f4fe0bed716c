"""The text between the components and the loop: every campaign of the library, names, help for debuggers, plug-ins."""

from __future__ import annotations

import ast
import json
import linecache
import os
import subprocess
import sys
import textwrap
import traceback
import types
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from campaigns import library, load_file
from worker.catalogue.installed import components
from worker.kernels import assemble, maths
from worker.kernels.assemble import Loop
from worker.kernels.layout import Parts
from worker.kernels.text.names import Names, UnnamedError
from worker.kernels.text.scenario import WIDTH
from worker.kernels.text.written import FUNCTIONS, written
from worker.systems.problem import Problem

EARLIER = json.loads((Path(__file__).parents[1] / "golden" / "closed_loops.json").read_text(encoding="utf-8"))
"""State and guidance after 25 steps, and what a trace shows there, of one random point of every campaign, flown in
plain Python by the templates with slots that this text replaced."""


@pytest.mark.parametrize("name", library())
def test_the_library(name: str) -> None:
    problem = Problem(load_file(library()[name]), compiled=False)
    loop = Loop(problem.parts, lanes=1, compiled=False)
    check(loop.text)
    point = np.random.default_rng(7).random((1, problem.dimension))
    vector = problem.realisations.flights(problem.vectors(point))[:1]
    trace = loop.fly(vector, problem.step, 25, problem.counts(problem.step)[1], traced=1).trace[0]
    assert trace[-1] == pytest.approx(np.array(EARLIER[name]["state"]), rel=1e-9, abs=1e-12)
    seen = loop.observe(trace, vector[0], problem.step)[-1]
    assert seen == pytest.approx(np.array(EARLIER[name]["seen"]), rel=1e-9, abs=1e-12)


def check(text: str) -> None:
    """It parses, its lines fit, every function says what it is, and no variable hides a module."""
    tree = ast.parse(text)
    assert max(map(len, text.splitlines())) <= WIDTH
    modules = {
        a.asname or a.name for node in tree.body if isinstance(node, ast.Import | ast.ImportFrom) for a in node.names
    }
    functions = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
    assert [ast.get_docstring(f) for f in functions] == [FUNCTIONS[f.name] for f in functions]
    for function in functions:
        stored = {n.id for n in ast.walk(function) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
        assert not modules & (stored | {a.arg for a in function.args.args}), function.name


def parts(**own: Any) -> Parts:
    """The unicycle among circles, with components of one's own."""
    known: Any = components()
    given = {
        "vehicle": known["vehicle", "unicycle"],
        "controller": known["controller", "pid_speed"],
        "avoider": known["avoider", "potential_field"],
        "obstacles": (known["obstacle", "circle"],),
        "criterion": known["criterion", "separation"],
    }
    return Parts(**given | own)


def vector(loop: Loop, **own: float) -> Any:
    given = {"goal.x": 6.0, "goal.y": 7.0, "criterion.threshold": 0.5, **own}
    named = [(f"{s.prefix}.{p.name}", p.default) for s in loop.sections for p in s.parameters]
    return np.array([given.get(name, 4.0 if default is None else default) for name, default in named])


# Names


POST = """
from typing import Annotated, NamedTuple
from worker.kernels.component import Obstacle, Parameter
from worker.kernels.maths import kernel, norm2
from worker.kernels.views import Body

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
    loop = Loop(parts(obstacles=(near.component, far.component)), compiled=False)
    assert "from some_near import post\n" in loop.text
    assert "from some_far import post as some_far_post\n" in loop.text
    check(loop.text)
    seen = loop.part("bodies")(0.0, (), (0.0, 0.0), loop.extend(vector(loop)))
    assert [b.radius for b in seen] == [0.5, 1.5]


@pytest.mark.parametrize("name", ["goal", "obstacle_0", "xv", "closed_loop", "views"])
def test_a_module_named_like_something_of_the_text(name: str, module: Any) -> None:
    loop = Loop(parts(obstacles=(module(name, "RADIUS = 0.5\n" + POST).component,)), compiled=False)
    check(loop.text)
    assert loop.part("bodies")(0.0, (), (0.0, 0.0), loop.extend(vector(loop)))[0].radius == 0.5


def test_modules_are_named_apart() -> None:
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
    with pytest.raises(UnnamedError, match=r"obstacle 'post': 'body' is not found by name in module some_made; define"):
        Loop(parts(obstacles=(made.component,)))


# What stands in it


@pytest.mark.parametrize(
    ("avoider", "memory"), [("potential_field", 0), ("gnron", 0), ("closest_approach", 1)], ids=lambda v: str(v)
)
def test_guidance_is_asked_once_for_what_a_trace_holds(avoider: str, memory: int) -> None:
    """Where guidance is continuous too: the held columns of a trace are the first demand, not zeros."""
    found: Any = components()["avoider", avoider]
    loop = Loop(parts(avoider=found), lanes=1, compiled=False)
    given = vector(loop)
    held = loop.fly(given[None], 0.005, 3, traced=1).trace[0, :, loop.n_state :]
    p = loop.extend(given)
    x = loop.part("initial")(p)
    _, q, v, seen = loop.part("aware")(0.0, x, p)
    first = loop.part("asked")(0.0, q, v, seen, loop.part("blank")(p)[2:], p)[0]
    assert held[0, :2].tolist() == list(first)
    assert any(first)
    if not found.memory:
        assert held.tolist() == [list(first)] * 4


@pytest.mark.parametrize("name", ["unicycle_static", "uav_static", "uav_moving_gusts", "pioneer_dropout"])
def test_the_reference_calls_the_platforms_functions(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """As often as the loop calls the polynomials, and these not once: else they would be checked against themselves."""
    calls = {maths.sincos: 0, maths.atan2: 0, maths.log: 0}

    def counting(kernel: Any, other: Any) -> Any:
        def counted(*arguments: float) -> Any:
            calls[kernel] += 1
            return other(*arguments)

        return counted

    for kernel, other in list(assemble.LIBRARY.items()):
        monkeypatch.setitem(assemble.LIBRARY, kernel, counting(kernel, other))
    problem = Problem(load_file(library()[name]), compiled=False)
    loop = problem.loop
    with np.errstate(over="ignore"):  # random bits are products of whole numbers that wrap
        p = loop.extend(problem.realisations.flights(problem.nominal[None])[0])
        x, g = loop.part("initial")(p), loop.part("blank")(p)
    codes = {kernel.py_func.__code__: kernel for kernel in calls}
    polynomials = dict.fromkeys(calls, 0)

    def watch(frame: types.FrameType, event: str, _: Any) -> None:
        if event == "call" and frame.f_code in codes:
            polynomials[codes[frame.f_code]] += 1

    def asked(library: bool) -> Any:
        sys.setprofile(watch)
        try:
            with np.errstate(over="ignore"):
                held = loop.part("guide", library)(0.0, x, g, p)
                return loop.part("closed_loop", library)(0.0, x, held, p)
        finally:
            sys.setprofile(None)

    slope, channels = asked(library=False)
    expected = polynomials.copy()
    assert expected[maths.sincos] > 3
    assert not any(calls.values())
    polynomials.update(dict.fromkeys(calls, 0))
    other_slope, other_channels = asked(library=True)
    assert calls == expected
    assert not any(polynomials.values())
    assert other_slope == pytest.approx(slope, rel=1e-9, abs=1e-9)
    assert other_channels == pytest.approx(channels, rel=1e-9, abs=1e-9)


# For debuggers


def test_a_traceback_shows_the_line_of_the_text() -> None:
    loop = Loop(parts(), compiled=False)
    with pytest.raises(TypeError) as caught:
        loop.part("closed_loop")(0.0, None, (), loop.extend(vector(loop)))
    shown = traceback.extract_tb(caught.value.__traceback__)
    at = next(frame for frame in shown if frame.name == "aware")
    assert at.filename == loop.module.__file__
    assert at.line == "xm = unicycle.measured(x[0:5], views.NO_ERRORS, vehicle)"
    assert Path(at.filename).read_text(encoding="utf-8") == loop.text


def test_where_no_file_can_be_written_the_lines_are_known(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "no_folder").touch()
    monkeypatch.setenv("CLEARANCE_KERNEL_CACHE", str(tmp_path / "no_folder"))
    loop = Loop(parts(), compiled=False)
    assert loop.module.__file__ is not None
    assert not Path(loop.module.__file__).exists()
    assert linecache.getlines(loop.module.__file__) == loop.text.splitlines(keepends=True)


def test_a_file_that_was_edited_is_written_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CLEARANCE_KERNEL_CACHE", str(tmp_path))
    file = Path(Loop(parts(), compiled=False).module.__file__ or "")
    file.write_text("edited", encoding="utf-8")
    loop = Loop(parts(), compiled=False)
    assert file.read_text(encoding="utf-8") == loop.text
    assert [f.name for f in file.parent.iterdir()] == [file.name], "no draft is left"


# Components of other packages: no answer is stale


FAR = """
from worker.kernels.maths import kernel

@kernel
def grown(radius):
    return radius + 0.25
"""

NEAR = """
import numpy as np
from worker.kernels.maths import kernel
import some_package.far as far

@kernel
def beyond(radius):
    return far.grown(radius)
"""

FLIES = """
import json
import numpy as np
from some_package import post
from tests.unit.test_text import parts, vector
from worker.kernels.assemble import Loop

loop = Loop(parts(obstacles=(post.component,)))
flown = loop.fly(vector(loop)[None], 0.005, 800)
stats = loop._fly.stats
print(json.dumps({"digest": loop.digest, "cost": flown.costs[0, 0], "hits": sum(stats.cache_hits.values())}))
"""


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
