"""`search`: checks its arguments, makes the campaign that they describe, and runs it in this process.

Everything is checked before anything is evaluated. The campaign runs through the same stages as `clearance run`; only
the system is a function of this process.
"""

from __future__ import annotations

import ast
import inspect
import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from clearance.function.result import Interrupted, Result
from clearance.function.searches import searches, stages
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
    data_paths,
    finite,
    only_loaded,
)

MAX_SEED = 2**53
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


def search(
    fly: Callable[..., Any],
    parameters: Mapping[str, Range] | None = None,
    threshold: float | None = None,
    *,
    nominal: Mapping[str, float] | None = None,
    methods: Sequence[str] | Mapping[str, int] | None = None,
    budget: int | None = None,
    options: Mapping[str, Mapping[str, Any]] | None = None,
    starts: Sequence[Mapping[str, float]] | None = None,
    validation: int | None = None,
    agreement: float | None = None,
    certify: int = 300,
    workers: int | None = None,
    resume: Result | Interrupted | str | Path | None = None,
    seed: int = 1,
    sample_seed: int | None = None,
    vectorized: bool | None = None,
    progress: bool = False,
    name: str = "",
    quantity: str = "",
    unit: str = "",
    worse: Literal["low", "high"] = "low",
    result: str = "",
    reads: Sequence[str | Path] = (),
) -> Result:
    """Search for the worst case of a function, and state what may be claimed.

    fly: called as `fly(mass=..., drag=...)` with floats, returns one number; with `vectorized`, called with arrays (m,)
    and returns an array (m,). Or a function decorated with `clearance.simulator`.
    parameters: the range (low, high) of each uncertain parameter, by keyword of the function; for a decorated function,
    by default those that it declares.
    threshold: the value [unit] above which an evaluation is clear; at or below it, it is a violation.
    nominal: the nominal case; the middle of its range for a parameter that is not named.
    methods: search methods by name, or by name with the evaluations of each; None: `auto`.
    budget: evaluations of each search whose method has none of its own; if not given, 1000 for each parameter, 500 if
        methods are named.
    options: of the methods, by method: `{"direct": {"iterations": 100}}`.
    starts: points to start from, by parameter, for the methods that take some; other parameters are nominal.
    validation: evaluations that distinguish the worst cases and confirm results, in all; None: at most as many as the
        searches. A run never takes more evaluations than `Result.bound`.
    agreement: fraction of nominal minus worst within which the methods must agree; 0.05 if not given.
    certify: size of the independent random sample that bounds the probability of a violation; 0 for none.
    workers: processes side by side that call the function, which must be in a file; None: in this process, or as a
        decorated function declares.
    resume: an earlier result, an `Interrupted`, or the folder of `Result.save`; its searches are not evaluated again,
        and with a larger budget they continue.
    seed: of everything random but the independent sample. progress: bars in a terminal, an updated table in a notebook.
    name: of the campaign.
    sample_seed: of the independent sample, to repeat an earlier result; nothing is cleared with one that was stated.
    quantity, unit: of the returned number, for sentences, tables and axes. worse: only "low".
    result: which result of a decorated function decides, if it has several.
    reads: the data files that the function reads, or folders of them, relative to its file, or to the working folder if
        it has none; their content is part of what identifies it. A decorated function declares them itself.

    An evaluation that raises, or returns anything but a finite number, fails with its reason, and the search goes on.
    Ctrl-C raises `Interrupted`, a KeyboardInterrupt that has what was evaluated until then.

    Raises ValueError or TypeError with a sentence before anything is evaluated if an argument cannot be used, and
    ValueError if none of the first evaluations has a value or the nominal case is excluded.
    """
    if only_loaded():
        raise RuntimeError(
            "a search was started while its file is only loaded for its functions: "
            "put the call of clearance.search under `if __name__ == '__main__':`"
        )
    budget, validation, workers, certify, seed, sample_seed, methods, options, starts = (
        _python(value) for value in (budget, validation, workers, certify, seed, sample_seed, methods, options, starts)
    )
    _plain(threshold, worse)
    _counts(budget=budget, validation=validation, workers=workers, certify=certify, seed=seed, sample_seed=sample_seed)
    if agreement is not None and not (finite(agreement) and 0.0 < agreement <= 1.0):
        raise ValueError(f"agreement must be a fraction above 0 and at most 1, given {agreement!r:.60}")
    threshold = None if threshold is None else float(threshold)
    request = _request_of(fly, parameters, nominal, vectorized, quantity, unit, result, data_paths(reads))
    if workers is not None:
        request = _side_by_side(request, fly, workers)
    found = searches(methods, budget, options, starts, request.ranges)
    document = _document(request, threshold, name, stages(found, certify, validation), seed)
    if agreement is not None:
        document["agreement"] = float(agreement)
    from campaigns.sample_seed import SampleSeed
    from clearance.function.running import run

    return run(request, document, progress, None if sample_seed is None else SampleSeed(sample_seed), resume)


def _python(value: Any) -> Any:
    """With NumPy's numbers as Python's own."""
    if isinstance(value, np.generic | np.ndarray) and value.ndim == 0:
        return value.item()
    if isinstance(value, Mapping):
        return {name: _python(part) for name, part in value.items()}
    return [_python(part) for part in value] if isinstance(value, list | tuple) else value


def _plain(threshold: object, worse: object) -> None:
    if threshold is None or not finite(threshold):
        raise ValueError(f"threshold must be a finite number, given {threshold!r:.60}")
    if worse != "low":
        raise ValueError(
            f"worse={worse!r:.60} is not supported, a verdict needs a number that is worse when low: "
            "return the margin, such as limit - value, and give threshold=0"
        )


def _counts(**counts: object) -> None:
    """The whole numbers, of which some may be left out."""
    for label, value in counts.items():
        least = 1 if label in ("budget", "workers") else 0
        if value is None and label not in ("certify", "seed"):
            continue
        if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= MAX_SEED:
            raise ValueError(f"{label} must be a whole number of at least {least}, given {value!r:.60}")


def _request_of(
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
        reads=reads,
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


def _side_by_side(request: Request, fly: object, workers: int) -> Request:
    """The request with so many processes that call the function."""
    settings = replace(request.declaration.settings, isolated=True, slots=workers)
    call = fly.call if isinstance(fly, Function) else fly
    place = dict(request.place) or _found(call, request.declaration.name, f"workers={workers} is given", "omit workers")
    if request.declaration.reads and not isinstance(fly, Function):
        place[READS] = "\n".join(request.declaration.reads)
    return replace(request, declaration=replace(request.declaration, settings=settings), place=place)


def _place(fly: Function[..., Any]) -> dict[str, str]:
    """Where a process of its own finds the function; empty if it is called in this one."""
    isolated = fly.declaration.settings.isolated
    why, instead = "it is isolated", "declare it with isolated=False"
    return _found(fly.call, fly.declaration.name, why, instead) if isolated else {}


def _found(call: object, name: str, why: str, instead: str) -> dict[str, str]:
    """Where a process of its own finds a function; why it needs to, and what to do instead."""
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


def _document(
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
