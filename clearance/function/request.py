"""What `search` is given, as the declaration of a function and the document of a campaign.

Everything is checked before anything is evaluated.
"""

from __future__ import annotations

import ast
import inspect
import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from worker.engine.systems.simulators.declared.external import READS
from worker.engine.systems.simulators.declared.function import (
    NAME,
    Declaration,
    Function,
    Output,
    Parameter,
    Settings,
    accepts,
    check,
    constants,
    finite,
)

ONLY_RUN = ("__name__ == '__main__'", "'__main__' == __name__")
"""The condition of what a process that loads the file does not run."""

Range = tuple[float, float]


@dataclass(frozen=True)
class Request:
    """The declaration of the function, where it is, and what is searched: ranges [unit] and nominal values [unit]."""

    declaration: Declaration
    call: Callable[..., Any]
    place: Mapping[str, str]
    ranges: Mapping[str, Range]
    nominal: Mapping[str, float]
    result: str


def request_of(
    fly: object, parameters: object, nominal: object, vectorized: bool | None, quantity: str, unit: str, result: str,
    reads: tuple[str, ...],
) -> Request:  # fmt: skip
    if isinstance(fly, Function):
        for label, own in (("vectorized", vectorized), ("quantity", quantity), ("unit", unit), ("reads", reads)):
            if own:
                raise ValueError(f"{label}: a decorated function declares this itself; leave it out")
        return _of_decorated(fly, parameters, nominal, result)
    if not callable(fly):
        raise TypeError(f"the first argument must be a function, given {fly!r:.60}")
    if result:
        raise ValueError("result: only a function decorated with clearance.simulator has several results")
    ranges = _ranges(parameters)
    middle = _nominal(nominal, {name: low + 0.5 * (high - low) for name, (low, high) in ranges.items()}, ranges)
    declared = {n: Parameter(low, high, middle[n], text=n) for n, (low, high) in ranges.items()}
    label = str(getattr(fly, "__name__", type(fly).__name__))
    settings = Settings(vectorized=bool(vectorized), isolated=False)
    output = Output(unit=_line("unit", unit, 30), quantity=_line("quantity", quantity, 60) or "value")
    declaration = Declaration(
        _named(label), _title(label), inspect.getdoc(fly) or "", declared, {"value": output}, settings,
        reads=reads, constants=constants(fly, declared),
    )  # fmt: skip
    check(declaration)
    accepts(fly, declared)
    return Request(declaration, fly, {}, ranges, middle, "value")


def _of_decorated(fly: Function[..., Any], parameters: object, nominal: object, result: str) -> Request:
    declaration = fly.declaration
    declared = {name: (float(p.low), float(p.high)) for name, p in declaration.parameters.items()}
    ranges = declared if parameters is None else _ranges(parameters)
    for name, (low, high) in ranges.items():
        if name not in declared:
            raise ValueError(f"{declaration.name} has no parameter {name!r}; it has {', '.join(declared)}")
        least, most = declared[name]
        if not least <= low < high <= most:
            raise ValueError(f"{name}: range {low:g} to {high:g} must be within {least:g} to {most:g} as declared")
    middle = _nominal(nominal, {name: float(p.usual) for name, p in declaration.parameters.items()}, declared)
    for name, (low, high) in ranges.items():
        if not low <= middle[name] <= high:
            raise ValueError(
                f"{name}: nominal value {middle[name]:g} must be within the range {low:g} to {high:g}; give nominal"
            )
    may = [name for name, output in declaration.results.items() if output.worse == "low"]
    if not may or (result and result not in may):
        raise ValueError(
            f"result: {result or 'none'} of {declaration.name} cannot decide; "
            f"a result that is worse when low is needed ({', '.join(may) or 'it has none'})"
        )
    return Request(declaration, fly.call, _place(fly), ranges, middle, result or may[0])


def side_by_side(request: Request, fly: object, workers: int) -> Request:
    """The request with so many processes that call the function."""
    settings = replace(request.declaration.settings, isolated=True, slots=workers)
    call = fly.call if isinstance(fly, Function) else fly
    place = dict(request.place) or _found(call, request.declaration.name, f"workers={workers} is given", "omit workers")
    if request.declaration.reads and not isinstance(fly, Function):
        place[READS] = "\n".join(request.declaration.reads)
    return replace(request, declaration=replace(request.declaration, settings=settings), place=place)


def _place(fly: Function[..., Any]) -> dict[str, str]:
    """The file in which a process of its own finds the function; empty if it is called in this one."""
    isolated = fly.declaration.settings.isolated
    why, instead = "it is isolated", "declare it with isolated=False"
    return _found(fly.call, fly.declaration.name, why, instead) if isolated else {}


def _found(call: object, name: str, why: str, instead: str) -> dict[str, str]:
    """The file in which a process of its own finds a function; why it needs to, and what to do instead."""
    qualified, module = getattr(call, "__qualname__", "<lambda>"), sys.modules.get(str(getattr(call, "__module__", "")))
    file = getattr(module, "__file__", None)
    nested = "<locals>" in qualified or "<lambda>" in qualified
    if nested or module is None or file is None or not _at_top(module.__name__, file, qualified.partition(".")[0]):
        raise ValueError(
            f"{name}: {why}, but a process of its own cannot find it, because it is not in a file or not at its "
            f"top level: put it in a file, outside `if __name__ == '__main__'`, or {instead}"
        )
    if module.__name__ == "__main__" or getattr(module, "__spec__", None) is None:
        return {"file": str(file), "name": qualified}
    return {"module": module.__name__, "name": qualified}


def _at_top(module: str, file: str, name: str) -> bool:
    """Whether a process that loads the file finds the name: in a program, what is under `if __name__ == "__main__"` is
    not run there."""
    try:
        return module != "__main__" or name in _names(ast.parse(Path(file).read_bytes()).body)
    except (OSError, SyntaxError, ValueError):
        return False


def _names(body: Sequence[ast.stmt]) -> Iterator[str]:
    """What these statements define, whichever branches of theirs are run."""
    for one in body:
        only_run = isinstance(one, ast.If) and ast.unparse(one.test) in ONLY_RUN
        parts = one.orelse if isinstance(one, ast.If) and only_run else [one]
        for node in (node for part in parts for node in ast.walk(part)):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
                yield node.name
            elif isinstance(node, ast.alias):
                yield node.asname or node.name.partition(".")[0]
            elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
                yield node.id


def _ranges(parameters: object) -> dict[str, Range]:
    if not isinstance(parameters, Mapping) or not parameters:
        raise TypeError(f"parameters must be a dict such as {{'mass': (1.5, 2.3)}}, given {parameters!r:.60}")
    found = {}
    for name, bounds in parameters.items():
        try:
            low, high = bounds
        except (TypeError, ValueError):
            raise TypeError(f"{name}: give a range (low, high), given {bounds!r:.60}") from None
        for value in (low, high):
            if not finite(value):
                raise ValueError(f"{name}: low and high must be finite numbers, at most 1e12, given {value!r:.60}")
        if not low < high:
            raise ValueError(f"{name}: low {low:g} must be below high {high:g}")
        found[name] = (float(low), float(high))
    return found


def _nominal(nominal: object, usual: Mapping[str, float], limits: Mapping[str, Range]) -> dict[str, float]:
    if nominal is None:
        return dict(usual)
    if not isinstance(nominal, Mapping):
        raise TypeError(f"nominal must be a dict of values by parameter, given {nominal!r:.60}")
    for name, value in nominal.items():
        if name not in limits:
            raise ValueError(f"nominal: there is no parameter {name!r}; there is {', '.join(limits)}")
        low, high = limits[name]
        if not finite(value) or not low <= value <= high:
            raise ValueError(f"nominal: {name} must be a number within {low:g} to {high:g}, given {value!r:.60}")
    return {name: float(nominal.get(name, value)) for name, value in usual.items()}


def document_of(
    request: Request, threshold: float | None, name: str, stages: Mapping[str, object], seed: int
) -> dict[str, object]:
    """The campaign as `clearance run` reads one."""
    return {
        "name": _line("name", name, 120) or request.declaration.title,
        "simulator": {
            "name": request.declaration.name,
            "parameters": dict(request.nominal),
        },
        "uncertain": {f"simulator.{n}": {"low": low, "high": high} for n, (low, high) in request.ranges.items()},
        "criterion": {"result": request.result, "threshold": threshold},
        "stages": stages,
        "seed": seed,
    }


def _named(label: str) -> str:
    """The name of a function as that of a simulator: small letters, digits and _."""
    name = re.sub(r"[^a-z0-9_]+", "_", label.lower()).strip("_")[:60]
    return name if NAME.fullmatch(name) else "function"


def _title(label: str) -> str:
    return "".join(c for c in label if c.isprintable())[:100] or "function"


def _line(label: str, text: object, longest: int) -> str:
    if not isinstance(text, str) or not (text.isprintable() and len(text) <= longest):
        raise ValueError(f"{label} must be one line of text of at most {longest} characters, given {text!r:.60}")
    return text.strip()
