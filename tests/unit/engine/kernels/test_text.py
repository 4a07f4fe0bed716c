"""The generated text between components and loop: all library campaigns, called functions, debugging aids."""

from __future__ import annotations

import json
import linecache
import sys
import traceback
import types
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from campaigns import Campaign, library, load_file
from campaigns.asked.load import load_document
from clearance.testing.problems import Problem
from tests.given.assembled_loops import check, parts, vector
from tests.given.at_night import nightly_but
from tests.given.reference_in_python import part
from worker.engine.kernels import maths
from worker.engine.reference import compiled
from worker.engine.systems.closed_loop import assemble
from worker.engine.systems.closed_loop.assemble import Loop
from worker.running.catalogue.installed import components

EARLIER = json.loads((Path(__file__).parents[3] / "golden" / "closed_loops.json").read_text(encoding="utf-8"))
"""State and guidance after 25 steps, and what a trace shows there, of one random point of every campaign of the library
and of some with several faults on every path; simulated in plain Python by the templates that this text replaced. The
two with wind and errors of heading are of this text: the old one read the airspeed with the wrong attitude."""


def test_no_campaign_of_the_library_is_left_out() -> None:
    assert set(library()) <= set(EARLIER)


@pytest.mark.by_day(4)
@pytest.mark.parametrize("name", nightly_but(list(EARLIER)[::3], EARLIER))
def test_the_library_simulates_as_before(name: str) -> None:
    problem = Problem(campaign(name), compiled=False)
    loop = problem.system.loop
    check(loop.text)
    point = np.random.default_rng(7).random((1, problem.dimension))
    vector = problem.realisations.flights(problem.vectors(point))[:1]
    flown = loop.simulate(vector, problem.system.step, 25, problem.system.counts(problem.system.step)[1], traced=1)
    assert flown.trace[0, -1] == pytest.approx(np.array(EARLIER[name]["state"]), rel=1e-9, abs=1e-12)
    seen = loop.observe(flown.trace[0], vector[0], problem.system.step)[-1]
    assert seen == pytest.approx(np.array(EARLIER[name]["seen"]), rel=1e-9, abs=1e-12)
    if "costs" in EARLIER[name]:
        assert flown.costs[0] == pytest.approx(np.array(EARLIER[name]["costs"]), rel=1e-9, abs=1e-12)


def campaign(name: str) -> Campaign:
    """A campaign of the library, or one of its scenarios with changes."""
    found = load_file(library()[name.partition(",")[0]])
    if name in library():
        return found
    document, change = found.document(), EARLIER[name]["change"]
    document["scenario"] |= change["scenario"]
    document |= {"objectives": change.get("objectives", []), "uncertain": {"start.x": {"plus_minus": 1e-3}}}
    document["stages"] = {"search": [{"method": "direct", "evaluations": 1}]}
    return load_document(document)


# What stands in it


@pytest.mark.parametrize("avoider", ["potential_field", "gnron", "closest_approach"])
def test_guidance_is_asked_once_for_what_a_trace_holds(avoider: str) -> None:
    """Also for continuous guidance: the held columns of a trace are the first demand, not zeros."""
    found: Any = components()["avoider", avoider]
    loop = Loop(parts(avoider=found), lanes=1, compiled=False)
    given = vector(loop)
    held = loop.simulate(given[None], 0.005, 3, traced=1).trace[0, :, loop.n_state :]
    p = loop.extend(given)
    x = loop.part("initial")(p)
    _, q, v, seen = loop.part("measurements")(0.0, x, p)
    first = loop.part("avoider_demand")(0.0, q, v, seen, loop.part("initial_guidance")(p)[2:], p)[0]
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
    loop = problem.system.loop
    with np.errstate(over="ignore"):  # random bits are products of whole numbers that wrap
        p = loop.extend(problem.realisations.flights(problem.system.nominal[None])[0])
        x, g = loop.part("initial")(p), loop.part("initial_guidance")(p)
    codes = {kernel.py_func.__code__: kernel for kernel in calls}
    polynomials = dict.fromkeys(calls, 0)

    def watch(frame: types.FrameType, event: str, _: Any) -> None:
        if event == "call" and frame.f_code in codes:
            polynomials[codes[frame.f_code]] += 1

    def flown(function: Callable[[str], Any]) -> Any:
        sys.setprofile(watch)
        try:
            with np.errstate(over="ignore"):
                guidance = function("guide")(0.0, x, g, p)
                return function("closed_loop")(0.0, x, guidance, p)
        finally:
            sys.setprofile(None)

    slope, channels = flown(loop.part)
    expected = polynomials.copy()
    assert expected[maths.sincos] > 3
    assert not any(calls.values())
    polynomials.update(dict.fromkeys(calls, 0))
    other_slope, other_channels = flown(partial(part, loop))
    assert calls == expected
    assert not any(polynomials.values())
    assert other_slope == pytest.approx(slope, rel=1e-9, abs=1e-9)
    assert other_channels == pytest.approx(channels, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("name", ["unicycle_static", "uav_moving_gusts"])
def test_the_compiled_reference_reaches_no_polynomial(name: str) -> None:
    loop = Problem(load_file(library()[name]), compiled=False).system.loop
    polynomials = {kernel.py_func.__code__ for kernel in assemble.LIBRARY}
    assert polynomials & reached(loop.kernel("closed_loop"), set()) >= {maths.sincos.py_func.__code__}
    assert not polynomials & reached(compiled.bound(loop), set())


def reached(value: Any, found: set[types.CodeType]) -> set[types.CodeType]:
    """The code of every function of Python that this one may call, through modules and closures as well."""
    function = getattr(value, "py_func", value)
    if isinstance(function, types.FunctionType) and function.__code__ not in found:
        found.add(function.__code__)
        names = function.__code__.co_names
        cells = [cell.cell_contents for cell in function.__closure__ or ()]
        for each in [*(function.__globals__.get(name) for name in names), *cells]:
            own = [vars(each).get(name) for name in names] if isinstance(each, types.ModuleType) else [each]
            for inner in own:
                reached(inner, found)
    return found


# For debuggers


def test_a_traceback_shows_the_line_of_the_text() -> None:
    loop = Loop(parts(), lanes=1, compiled=False)
    with pytest.raises(TypeError) as caught:
        loop.part("closed_loop")(0.0, None, (), loop.extend(vector(loop)))
    shown = traceback.extract_tb(caught.value.__traceback__)
    at = next(frame for frame in shown if frame.name == "measurements")
    assert at.filename == loop.module.__file__
    assert at.line == "xm = unicycle.measured(x[0:5], views.NO_ERRORS, vehicle)"
    assert Path(at.filename).read_text(encoding="utf-8") == loop.text


def test_where_no_file_can_be_written_the_lines_are_known(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "no_folder").touch()
    monkeypatch.setenv("CLEARANCE_KERNEL_CACHE", str(tmp_path / "no_folder"))
    loop = Loop(parts(), lanes=1, compiled=False)
    assert loop.module.__file__ is not None
    assert not Path(loop.module.__file__).exists()
    assert linecache.getlines(loop.module.__file__) == loop.text.splitlines(keepends=True)


def test_a_file_that_was_edited_is_written_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CLEARANCE_KERNEL_CACHE", str(tmp_path))
    file = Path(Loop(parts(), lanes=1, compiled=False).module.__file__ or "")
    file.write_text("edited", encoding="utf-8")
    loop = Loop(parts(), lanes=1, compiled=False)
    assert file.read_text(encoding="utf-8") == loop.text
    assert [f.name for f in file.parent.iterdir()] == [file.name], "no draft is left"
