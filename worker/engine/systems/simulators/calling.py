"""Calls a Python function for one evaluation: its results, or a sentence on why there are none; `child` runs it.

Only the standard library is imported at first: the process of a slot loads this file before its path is set, which
`FUNCTION` in its environment gives, with the function.
"""

from __future__ import annotations

import functools
import importlib
import inspect
import json
import linecache
import math
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypedDict

FUNCTION = "CLEARANCE_FUNCTION"
"""Set in the process of a slot that calls a function: which one, and where it is."""
LONGEST = 300
"""Characters of a message that are stored."""


class Answer(TypedDict, total=False):
    """The numbers by name, why there are none, or why the case does not count."""

    results: dict[str, float]
    failed: str
    excluded: str


class Traced(TypedDict, total=False):
    """An answer, and if it has results the columns of its trace by name, as returned."""

    results: Answer
    trace: dict[str, object]


class Evaluate:
    """The function that the environment names, for one set of parameters: its results, and on request its trace."""

    def __call__(self, /, **parameters: float) -> Answer:
        call, names, vectorized = _named()
        return _counting(called(call, parameters, names, vectorized))

    def traced(self, /, **parameters: float) -> Traced:
        call, names, vectorized = _named()
        found = traced(call, parameters, names, vectorized)
        _counting(found["results"])
        return found


evaluate = Evaluate()


def _counting(answer: Answer) -> Answer:
    """The answer, unless the case does not count: the process of the slot reports that in place of an answer."""
    if "excluded" in answer:
        from worker.engine.systems.simulators.declared.excluded import Excluded

        raise Excluded(answer["excluded"])
    return answer


def called(
    call: Callable[..., Any], parameters: Mapping[str, float], names: Sequence[str], vectorized: bool = False
) -> Answer:
    """`{"results": numbers by name}`, `{"failed": sentence}` or `{"excluded": reason}`; whatever the function raises,
    except an interrupt."""
    try:
        if not vectorized:
            return read(call(**parameters), names)
        import numpy as np

        value = call(**{name: np.array([level]) for name, level in parameters.items()})
        if isinstance(value, Mapping):
            return read({name: _only(inner) for name, inner in value.items()}, names)
        return read(_only(value), names)
    except Wrong as error:
        return {"failed": str(error)}
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # whatever a function raises fails its evaluation alone
        reason = excluded(error)
        return {"excluded": reason} if reason else {"failed": failure(error, call)}


def excluded(error: BaseException) -> str:
    """Why the case does not count, if that is what the function raised; empty otherwise."""
    from worker.engine.systems.simulators.declared.excluded import Excluded  # the path of a slot is set by now

    return error.excluded if isinstance(error, Excluded) else ""


def traced(
    call: Callable[..., Any], parameters: Mapping[str, float], names: Sequence[str], vectorized: bool = False
) -> Traced:
    """`{"results": as from `called`, "trace": columns by name}` of a function that is asked for its trace; without
    `trace` unless it has results."""
    returned: list[dict[str, object]] = []

    @functools.wraps(call)  # a reason then names the line of the function
    def with_trace(**arguments: Any) -> Any:
        value = call(**arguments, trace=True)
        if not isinstance(value, (tuple, list)) or len(value) != 2:
            pair = "a pair of its results and a dict of columns is expected"
            raise Wrong(f"with trace=True it returned {described(value)}; {pair}")
        if not isinstance(value[1], Mapping):
            raise Wrong(f"with trace=True its columns are {described(value[1])}; a dict of lists by name is expected")
        returned.append(dict(value[1]))
        return value[0]

    results = called(with_trace, parameters, names, vectorized)
    return {"results": results, "trace": returned[0]} if "results" in results else {"results": results}


def read(value: Any, names: Sequence[str]) -> Answer:
    """What a function returned, as numbers by name; the first that is no finite number is the reason."""
    if isinstance(value, float) and math.isfinite(value) and len(names) == 1:
        return {"results": {names[0]: float(value)}}
    try:
        if not isinstance(value, Mapping):
            if len(names) > 1:
                raise Wrong(f"it returned {described(value)}; return a dict with {', '.join(names)}")
            return {"results": {names[0]: number(value, "it returned")}}
        if missing := [name for name in names if name not in value]:
            listed = ", ".join(str(k)[:40] for k in list(value)[:8]) or "nothing"
            raise Wrong(f"its results lack {missing[0]}; it returned {listed}")
        return {"results": {name: number(value[name], f"its result {name} is") for name in names}}
    except Wrong as error:
        return {"failed": str(error)}


class Wrong(ValueError):
    """The value is not a finite number; the message is the reason."""


def number(value: Any, begun: str) -> float:
    """A finite number; raises `Wrong` with a sentence that begins with `begun`."""
    found = math.nan
    try:
        if getattr(value, "shape", ()) != ():
            raise Wrong(f"{begun} an array of shape {tuple(value.shape)}; one number is expected")
        kind = getattr(getattr(value, "dtype", None), "kind", "f")
        if kind == "O":
            return number(value.item(), begun)
        plain = not isinstance(value, (str, bytes, bytearray, bool, complex)) and hasattr(value, "__float__")
        if plain and kind in "fiu" and not getattr(value, "mask", False):
            found = float(value)
        else:
            plain = False
    except Wrong:
        raise
    except OverflowError:
        found, plain = math.inf, True
    except Exception as error:
        raise Wrong(f"{begun} {described(value)}, not a number ({type(error).__name__})") from None
    if not plain:
        hint = "; is a return statement missing?" if value is None else ", not a number"
        raise Wrong(f"{begun} {described(value)}{hint}")
    if not math.isfinite(found):
        raise Wrong(f"{begun} {found}, not a finite number")
    return found


def described(value: Any) -> str:
    """A value in a sentence: short values as they are, others by their type."""
    if value is None or isinstance(value, (bool, int, float, str)):
        text = repr(value)
        return text if len(text) <= 60 else f"{text[:57]}..."
    name = type(value).__name__
    return f"{'an' if name[:1].lower() in 'aeiou' else 'a'} {name}"


def failure(error: BaseException, call: Callable[..., Any]) -> str:
    """Type, message and line: `ZeroDivisionError: division by zero, at line 3 of drop.py: return 1 / mass`."""
    if isinstance(error, SystemExit):
        return f"it called sys.exit({error.code!r:.60})"
    try:
        message = " ".join(str(error).split())
    except Exception:
        message = "its message cannot be shown"
    message = "".join(c if c.isprintable() else "?" for c in message)
    text = f"{type(error).__name__}: {message[:LONGEST]}".removesuffix(": ")
    return text + _where(error, call)


def _where(error: BaseException, call: Callable[..., Any]) -> str:
    """The innermost line in the function's own file; nothing where it was never entered."""
    try:
        code = getattr(inspect.unwrap(_inner(call)), "__code__", None)
    except ValueError:
        code = None
    file = None if code is None else code.co_filename
    found, trace = None, error.__traceback__
    while trace is not None:
        if trace.tb_frame.f_code.co_filename == file:
            found = (trace.tb_lineno, trace.tb_frame.f_code)
        trace = trace.tb_next
    if found is None or file is None:
        return ""
    line, at = found
    place = Path(file).name if os.path.isfile(file) else at.co_name
    text = " ".join(linecache.getline(file, line).split())[:100]
    return f", at line {line} of {place}" + (f": {text}" if text else "")


def _inner(call: Callable[..., Any]) -> Callable[..., Any]:
    while isinstance(call, functools.partial):
        call = call.func
    return call


def _only(value: Any) -> Any:
    shape = getattr(value, "shape", None)
    if shape != (1,):
        shown = described(value) if shape is None else f"an array of shape {tuple(shape)}"
        raise Wrong(f"it returned {shown}; given arrays of shape (1,), an array of shape (1,) is expected")
    return value[0]


def packed(place: Mapping[str, str], names: Sequence[str], vectorized: bool) -> str:
    """How the process of a slot finds a function, as the value of an environment variable.

    place: its `name`, and its `file` or `module`.
    """
    return json.dumps({**place, "path": [p for p in sys.path if p], "names": list(names), "vectorized": vectorized})


@functools.cache
def _named() -> tuple[Callable[..., Any], tuple[str, ...], bool]:
    place = json.loads(os.environ[FUNCTION])
    here = str(Path(__file__).resolve().parent)
    sys.path[:] = [p for p in sys.path if p != here]  # else `import program` of a function would find ours
    sys.modules.pop(__name__, None)
    sys.path.extend(p for p in place["path"] if p not in sys.path)
    from worker.engine.systems.simulators.declared.function import DESCRIBING, loaded

    os.environ[DESCRIBING] = "1"
    module = loaded(Path(place["file"])) if "file" in place else importlib.import_module(place["module"])
    del os.environ[DESCRIBING]
    found: Any = module
    for part in place["name"].split("."):
        found = getattr(found, part)
    return getattr(found, "call", found), tuple(place["names"]), bool(place["vectorized"])


if __name__ == "calling":  # in a slot: load the function while the slot starts, not during the first evaluation
    _named()
