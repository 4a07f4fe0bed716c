"""Simulates a component in plain Python and checks what each of its kernels returns.

First for a moment, twice, which must give the same results; then for long enough that it moves, meets something, turns.
"""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator
from types import CodeType, FrameType, FunctionType
from typing import Any

import numpy as np

from worker.engine.kernels.bind import rebuilt
from worker.engine.kernels.component import Component, Controller, Obstacle, declared
from worker.engine.kernels.layout import Parts, states
from worker.engine.kernels.text.names import UnnamedError
from worker.engine.systems.closed_loop.assemble import Loop
from worker.running.examination.blame import mistake
from worker.running.examination.extents import check_gap, check_reach
from worker.running.examination.kernels import Slot, kernels
from worker.running.examination.mistake import Mistake
from worker.running.examination.reading import Source
from worker.running.examination.scenes import Own, nominal, scenes, usual
from worker.running.examination.turns import check_rate

STEP, STEPS = 0.01, 12
"""Step [s] and number of steps."""
LONG = 3000
"""Steps of the simulation that shows what goes wrong after some seconds."""
SHOWN = 15
"""The extent of an obstacle with states is checked so often in it."""

Calls = dict[CodeType, list[tuple[Any, ...]]]
"""The arguments of the first call of each kernel in each scene, by its code."""


def flown(component: Component, source: Source, own: Own) -> Calls:
    """Simulate every scene; returns with what the kernels were called. Raises `Mistake`."""
    calls: Calls = {}
    for parts in scenes(component, own):
        with np.errstate(all="ignore"):
            trace = _fly(component, parts, source, calls)
        if isinstance(component, Obstacle):
            check_reach(component, _states(component, parts, trace), STEP * LONG, source.line_of("reach"))
            check_gap(component, source.line_of("body"))
    for slot in kernels(component):
        if isinstance(component, Obstacle) and slot.field == "body" and _code(slot.function) in calls:
            values = {p.name: usual(p, "obstacles.0") for p in declared(component.parameters)}
            with contextlib.suppress(ArithmeticError):  # a body need not be known after so long
                check_rate(component, calls[_code(slot.function)][0], values, source.line_of("rate"))
        if slot.field == "switches":
            _check_switches(component, slot, source)
    return calls


def _states(obstacle: Obstacle, parts: Parts, trace: Any) -> list[tuple[float, tuple[float, ...]]]:
    """The states of an obstacle at some instants of a simulation, in which it is the only one."""
    last = states(parts).total
    rows = range(0, len(trace) if obstacle.states else 0, LONG // SHOWN)
    found = [(STEP * k, tuple(map(float, trace[k, last - obstacle.states : last]))) for k in rows]
    return [(time, there) for time, there in found if np.isfinite(there).all()]


def _fly(component: Component, parts: Parts, source: Source, calls: Calls) -> Any:
    """Simulate one scene; the states of the longest simulation of it."""
    watch = Watch(component, parts, source, calls)
    try:
        loop = Loop(parts, lanes=1, compiled=False)
        values = np.array([nominal(parts, loop.sections)])
        done: dict[int, Any] = {}
        fly = rebuilt(loop.filled_template(), done, watch.watched)

        def simulated(steps: int) -> Any:
            costs, status, when = np.empty((1, len(parts.criteria))), np.empty(1), np.empty(1)
            trace = np.full((1, steps + 1, loop.n_state + loop.n_held), np.nan)
            fly(values, STEP, steps, 4 if parts.sampled else steps + 1, costs, status, when, trace)
            return trace

        with watch.repeated():
            trace = simulated(STEPS)
        with watch.repeated():
            simulated(STEPS)
        observed = rebuilt(loop.kernel("observation"), done, watch.watched)
        state, guidance = trace[0, 0, : loop.n_state], trace[0, 0, loop.n_state :]
        extend = rebuilt(loop.kernel("extend"), done, watch.watched)
        observed(0.0, tuple(map(float, state)), tuple(map(float, guidance)), extend(tuple(map(float, values[0]))))
        longest = simulated(LONG)[0]
    except Mistake:
        raise
    except UnnamedError as error:
        raise Mistake(str(error).partition(": ")[2] or str(error), source.line_of()) from None
    except Exception as error:
        found = mistake(error, source.file, "while simulating the nominal values")
        raise found if found.line else Mistake(found.text, source.line_of()) from None
    if component is parts.vehicle:
        _check_start(parts, loop, trace, watch, extend(tuple(map(float, values[0]))))
    return longest


def _check_start(parts: Parts, loop: Loop, trace: Any, watch: Watch, p: Any) -> None:
    start = tuple(map(float, trace[0, 0, : loop.n_state]))
    code = float(loop.part("envelope")(0.0, start, p))
    if code > 0.0:
        limits = parts.vehicle.limits
        known = 1.0 <= code <= len(limits)
        text = limits[int(code) - 1].text if known else f"limit {code:g}, and only {len(limits)} are declared"
        raise Mistake(
            f"the vehicle is outside its envelope at the start ({text}): correct `outside` or the default start values",
            watch.source.line_of("outside"),
        )


class Watch:
    """Checks the results of the kernels of one component."""

    def __init__(self, component: Component, parts: Parts, source: Source, calls: Calls) -> None:
        self.source, self.calls = source, calls
        driven = parts.vehicle if isinstance(component, Controller) else None
        self.slots: dict[CodeType, Slot] = {
            _code(slot.function): slot for slot in kernels(component, driven) if not slot.plain
        }
        self._first: list[tuple[CodeType, str]] = []
        self._again: Iterator[tuple[CodeType, str]] | None = None
        self._counted = False

    @contextlib.contextmanager
    def repeated(self) -> Iterator[None]:
        """Two blocks in which every call must give the same result; raises `Mistake` in the second one."""
        self._counted = True
        yield
        self._counted, self._again = False, iter(self._first)

    def _compare(self, function: FunctionType, arguments: tuple[Any, ...], result: Any) -> None:
        found = function.__code__, repr((arguments, result))
        if self._again is None:
            self._first.append(found)
        elif next(self._again, None) != found:
            raise Mistake(
                f"{function.__name__} gives another result when the same case is simulated again: a component may keep "
                "nothing but its state and memory, and nothing in it may be random",
                _line_of_return(function, arguments),
            )

    def watched(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """The function, checked if it is in the component's file."""
        assert isinstance(function, FunctionType)
        code = function.__code__
        if code.co_filename != str(self.source.file):
            return function
        slot = self.slots.get(code)

        def called(*arguments: Any) -> Any:
            if code not in self.calls:
                self.calls[code] = [arguments]
            result = function(*arguments)
            found = "" if slot is None or slot.shape is None else slot.shape.wrong(result)
            if found:
                raise Mistake(_sentence(function, slot, found, arguments), _line_of_return(function, arguments))
            if self._counted:
                self._compare(function, arguments, result)
            return result

        return called


def _sentence(function: Callable[..., Any], slot: Slot | None, found: str, arguments: tuple[Any, ...]) -> str:
    when = ""
    if "finite" in found and slot is not None and slot.arguments[0] == "t":
        when = f" at t = {arguments[0]:g} s with the nominal values"
    elif "finite" in found:
        when = " with the nominal values"
    advice = ": look for a division by zero or a wrong default" if "finite" in found else ""
    return f"{getattr(function, '__name__', 'it')} returns {found}{when}{advice}"


def _line_of_return(function: Callable[..., Any], arguments: tuple[Any, ...]) -> int:
    """The line of the `return` that these arguments reach, by calling the function again."""
    assert isinstance(function, FunctionType)
    lines: list[int] = []

    def trace(frame: FrameType, event: str, _: Any) -> Any:
        if frame.f_code is not function.__code__:
            return None
        if event == "return":
            lines.append(frame.f_lineno)
        return trace

    before = sys.gettrace()
    sys.settrace(trace)
    try:
        function(*arguments)
    finally:
        sys.settrace(before)
    return lines[-1] if lines else function.__code__.co_firstlineno


def _check_switches(component: Component, slot: Slot, source: Source) -> None:
    owner: Any = component.parameters if component.derived is None else None
    if owner is None or any(v is None for v in (owner._field_defaults.get(f) for f in owner._fields)):
        return
    try:
        found = slot.function(owner(), 10.0)
    except Exception as error:
        raise mistake(error, source.file, "while calling switches with the default values") from None
    if not isinstance(found, list) or not all(isinstance(each, int | float) for each in found):
        raise Mistake(
            f"switches returns {type(found).__name__}, expected a list of instants [s], such as [p.at]",
            source.line_of("switches"),
        )
    whole = getattr(component, "whole", 0)
    if not 0 <= whole < max(len(found), 1):
        raise Mistake(
            f"whole is {whole}, expected the index of one of the {len(found)} instants that switches returns, from 0",
            source.line_of("whole"),
        )


def _code(function: Any) -> CodeType:
    code: CodeType = getattr(function, "py_func", function).__code__
    return code
