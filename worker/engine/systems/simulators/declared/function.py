"""A Python function as a simulator: the decorator `simulator`, and the declaration that it makes.

Only the standard library is imported, so that the process of a slot, which imports the file with the function, starts
quickly.
"""

from __future__ import annotations

import functools
import importlib.util
import inspect
import os
import re
import reprlib
import sys
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import ModuleType
from typing import Any, Generic, Literal, ParamSpec, TypeVar

from worker.engine.systems.simulators.declared.columns import Column, columns

P = ParamSpec("P")
R = TypeVar("R")

NAME = re.compile(r"[a-z][a-z0-9_]{0,59}", re.ASCII)
PARAMETER = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,59}", re.ASCII)
LARGEST = 1e12
"""No quantity of a campaign may be larger than this, in its own unit."""

DESCRIBING = "CLEARANCE_DESCRIBING"
"""Set while a process loads a file only for its functions; nothing may be searched meanwhile."""


@dataclass(frozen=True)
class Parameter:
    """An input of a simulator: the limits of what may be asked [unit], the nominal value (the middle if not given)."""

    low: float
    high: float
    nominal: float | None = None
    unit: str = ""
    text: str = ""
    symbol: str = ""

    @property
    def usual(self) -> float:
        """The nominal value [unit]."""
        return self.low + 0.5 * (self.high - self.low) if self.nominal is None else self.nominal


@dataclass(frozen=True)
class Output:
    """A number that a simulator returns; only one that is worse when low can decide a verdict."""

    unit: str = ""
    worse: Literal["low", "high"] = "low"
    title: str = ""
    quantity: str = ""
    text: str = ""


@dataclass(frozen=True)
class Settings:
    """How a function is called: for whole batches or once for each evaluation, in a process of its own or in this one.

    timeout: of one evaluation [s]; memory: address space of a process [bytes], 0 for no limit; slots: processes side by
    side, 0 for one for each core; recycle: evaluations until a process is replaced, 0 for never.
    """

    vectorized: bool = False
    isolated: bool = True
    timeout: float = 60.0
    memory: int = 0
    slots: int = 0
    recycle: int = 0


@dataclass(frozen=True)
class Declaration:
    """What a decorated function declares, as plain values."""

    name: str
    title: str
    text: str
    parameters: Mapping[str, Parameter]
    results: Mapping[str, Output]
    settings: Settings = field(default_factory=Settings)
    trace: Mapping[str, Column] = field(default_factory=dict)
    """The quantities over time that it returns on request, `time` among them; empty if none."""
    scene: Mapping[str, Any] | None = None
    """Which of them are positions of what, as `campaigns.results.scene.Scene`."""
    reads: tuple[str, ...] = ()
    """Its data files, relative to the folder of its file."""
    constants: Mapping[str, str] = field(default_factory=dict)
    """The values of the function's other parameters, which are the same in every call."""

    @property
    def drawn(self) -> Any:
        """The 3D view of a trace, a `Scene`, or None; raises ValueError if it cannot be used."""
        if self.scene is None:
            return None
        from worker.engine.systems.simulators.declared.scene import (
            scene_of,  # pydantic, which the process of a slot does not load
        )

        return scene_of(self.scene, {name: c.unit for name, c in self.trace.items()})


class Function(Generic[P, R]):
    """A function with its declaration; it is called as before."""

    def __init__(self, call: Callable[P, R], declaration: Declaration) -> None:
        functools.update_wrapper(self, call)
        self.call = call
        self.declaration = declaration

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> R:
        return self.call(*args, **kwargs)

    def __repr__(self) -> str:
        return f"<simulator {self.declaration.name}({', '.join(self.declaration.parameters)})>"

    def __reduce__(self) -> str:  # pickled by name, as functions are
        return self.call.__qualname__


def simulator(
    *,
    parameters: Mapping[str, Parameter | tuple[float, float]],
    results: Mapping[str, Output] | None = None,
    title: str = "",
    name: str = "",
    vectorized: bool = False,
    isolated: bool = True,
    timeout: float = 60.0,
    memory: int = 0,
    slots: int = 0,
    recycle: int = 0,
    trace: Mapping[str, Column | Mapping[str, str]] | None = None,
    scene: Mapping[str, Any] | None = None,
    reads: Sequence[str | Path] = (),
) -> Callable[[Callable[P, R]], Function[P, R]]:
    """Declare a function as a simulator that campaigns can name; the function stays callable.

    The function is called with its parameters by keyword, as floats, or as arrays (m,) with `vectorized`. It returns
    one number (an array (m,) with `vectorized`), or a dict of numbers by the names of `results` (by default one result,
    `value`). With `isolated` it is called in processes of its own, under the limits given: `timeout` [s], `memory`
    [bytes], `slots` processes side by side, each replaced after `recycle` evaluations. Otherwise it is called in the
    process that searches, which is faster and has no limits.

    trace: columns over time, `time` [s] among them, each a dict with `unit`, `text` and `symbol`. The function then has
    a further parameter `trace=False`; called with `trace=True`, it returns a pair: what it returns otherwise, and a
    dict of the columns, each a list or an array. scene: which columns are positions of what, for the 3D view, with the
    keys of a descriptor. reads: the data files that it reads, or folders of them, relative to the folder of its file;
    their content is part of what identifies it, and a function that reads others is not identified.

    Raises ValueError or TypeError if the declaration does not fit the function.
    """
    settings = Settings(vectorized, isolated, timeout, memory, slots, recycle)

    def declared(call: Callable[P, R]) -> Function[P, R]:
        if not callable(call):
            raise TypeError(f"@simulator decorates a function, given {type(call).__name__}")
        named = name or getattr(call, "__name__", "")
        inputs = {k: _parameter(k, v) for k, v in _mapping("parameters", parameters).items()}
        returned = {"value": Output()} if results is None else dict(_mapping("results", results))
        text = inspect.getdoc(call) or ""
        traced = {} if trace is None else columns(trace)
        data, others = data_paths(reads), constants(call, inputs)
        declaration = Declaration(named, title or named, text, inputs, returned, settings, traced, scene, data, others)
        check(declaration)
        accepts(call, inputs)
        if traced:
            _accepts_trace(call, inputs)
        if not only_loaded():
            _ = declaration.drawn
        return Function(call, declaration)

    return declared


def check(declaration: Declaration) -> None:
    """Raises ValueError or TypeError with a sentence for the first thing that cannot be used."""
    if not NAME.fullmatch(declaration.name):
        raise ValueError(
            f"invalid name {declaration.name!r}: give a name of small letters, digits and _, such as name='drop'"
        )
    for name, parameter in declaration.parameters.items():
        _check_parameter(name, parameter)
    for name, output in declaration.results.items():
        if not NAME.fullmatch(str(name)):
            raise ValueError(f"results: invalid name {name!r}: give small letters, digits and _, such as separation")
        if not isinstance(output, Output):
            raise TypeError(f"results: {name} must be an Output, such as Output(unit='m'), given {output!r:.60}")
        if output.worse not in ("low", "high"):
            raise ValueError(f"results: {name}: worse must be 'low' or 'high', given {output.worse!r}")
    _check_settings(declaration.settings)


def data_paths(reads: object) -> tuple[str, ...]:
    """The paths of data files; raises TypeError for anything else."""
    if isinstance(reads, list | tuple) and all(isinstance(path, str | Path) and str(path) for path in reads):
        return tuple(map(str, reads))
    raise TypeError(f"reads must be a list of paths, such as ['table.csv'], given {reads!r:.60}")


def accepts(call: Callable[..., Any], names: Mapping[str, object]) -> None:
    """Raises TypeError unless the function can be called with exactly these keywords."""
    try:
        signature = inspect.signature(call)
    except (TypeError, ValueError):  # a function of C without one
        return
    try:
        signature.bind(**dict.fromkeys(names))
    except TypeError as error:
        label = getattr(call, "__name__", type(call).__name__)
        keywords = ", ".join(f"{name}=..." for name in names)
        raise TypeError(
            f"{label}{signature} cannot be called as {label}({keywords}): {error}; "
            "name the parameters as the function does"
        ) from None


def constants(call: Callable[..., Any], names: Collection[str]) -> dict[str, str]:
    """The other parameters of a function, by name with what it receives for each: its default, or what
    `functools.partial` binds. Not those without a value, flags, and generators, which give other numbers in each
    call."""
    found: Any = {}
    inner: Any = call
    try:
        while inner is not None:
            defaults = {name: p.default for name, p in inspect.signature(inner).parameters.items()}
            found = {name: value for name, value in defaults.items() if value is not inspect.Parameter.empty} | found
            if isinstance(inner, functools.partial):
                found = {**inner.keywords, **inspect.signature(inner.func).bind_partial(*inner.args).arguments, **found}
                inner = inner.func
            else:
                inner = inspect.getattr_static(inner, "pyfunc", None)  # of numpy.vectorize
    except (TypeError, ValueError):  # a function of C without one
        return {}
    # reprlib bounds the text of any value, and has one for an object whose own raises
    return {name: reprlib.repr(value)[:60] for name, value in found.items() if name not in names and _constant(value)}


def _constant(value: object) -> bool:
    flag = value is None or isinstance(value, bool)
    return not flag and not callable(value) and inspect.getattr_static(value, "random", None) is None


def _accepts_trace(call: Callable[..., Any], names: Mapping[str, object]) -> None:
    """Raises ValueError or TypeError unless the function can also be called with `trace=True`."""
    if "trace" in names:
        raise ValueError("parameters: trace is the keyword by which a trace is requested; rename this parameter")
    try:
        accepts(call, {**names, "trace": True})
    except TypeError:
        label = getattr(call, "__name__", type(call).__name__)
        raise TypeError(
            f"trace: {label} declares columns, so it needs the further parameter trace=False; with trace=True it "
            "returns its results and a dict of the columns"
        ) from None


def finite(value: object) -> bool:
    """Whether it is a number that a campaign can state."""
    if isinstance(value, (bool, str)):
        return False
    try:
        return abs(float(value)) <= LARGEST  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        return False


def _mapping(what: str, value: object) -> Mapping[Any, Any]:
    if not isinstance(value, Mapping) or not value:
        raise TypeError(f"{what} must be a dict with at least one name, given {value!r:.60}")
    return value


def _parameter(name: str, value: object) -> Parameter:
    if isinstance(value, Parameter):
        return value
    if isinstance(value, (tuple, list)) and len(value) == 2:
        return Parameter(*value)
    raise TypeError(f"parameters: {name} must be a Parameter or a pair (low, high), given {value!r:.60}")


def _check_parameter(name: object, p: Parameter) -> None:
    if not isinstance(name, str) or not PARAMETER.fullmatch(name):
        raise ValueError(f"parameters: invalid name {name!r}: use letters, digits and _ of ASCII, at most 60")
    unit = f" [{p.unit}]" if p.unit else ""
    for label, value in (("low", p.low), ("high", p.high), ("nominal", p.usual if finite(p.low) else p.low)):
        if not finite(value):
            raise ValueError(
                f"{name}: {label} must be a finite number of at most {LARGEST:g} in magnitude, given {value!r:.60}"
            )
    if not p.low < p.high:
        raise ValueError(f"{name}: low {p.low:g} must be below high {p.high:g}{unit}")
    if not p.low <= p.usual <= p.high:
        raise ValueError(f"{name}: nominal {p.usual:g} must be within [{p.low:g}, {p.high:g}]{unit}")


def _check_settings(s: Settings) -> None:
    if not finite(s.timeout) or not 0 < s.timeout <= 86_400:
        raise ValueError(f"timeout must be above 0 s and at most 86400 s, given {s.timeout!r:.60}")
    for name, value, most in (("memory", s.memory, 2**62), ("slots", s.slots, 256), ("recycle", s.recycle, 2**62)):
        if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= most:
            raise ValueError(f"{name} must be a whole number from 0 to {most}, given {value!r:.60}")


def in_units(declaration: Declaration) -> Declaration:
    """The declaration with floats for all numbers, as JSON and campaigns have them."""
    parameters = {
        name: replace(p, low=float(p.low), high=float(p.high), nominal=float(p.usual))
        for name, p in declaration.parameters.items()
    }
    return replace(declaration, parameters=parameters)


def only_loaded() -> bool:
    """Whether this process loads a file only for its functions: to describe them, or in a slot to call one."""
    return DESCRIBING in os.environ


def loaded(file: Path, first: bool = True) -> ModuleType:
    """The module of a file, executed again; it can import the modules of its folder, which comes first or last."""
    folder = str(file.resolve().parent)
    if folder not in sys.path:
        sys.path.insert(0 if first else len(sys.path), folder)
    name = f"clearance_simulator_{file.stem}"
    spec = importlib.util.spec_from_file_location(name, file)
    if spec is None or spec.loader is None:
        raise ImportError(f"{file} is not a Python file")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # dataclasses look for it
    spec.loader.exec_module(module)
    return module


def declared_in(module: ModuleType) -> dict[str, Function[Any, Any]]:
    """The decorated functions of a module by attribute, each once, and only its own."""
    found: dict[int, tuple[str, Function[Any, Any]]] = {}
    for name, value in vars(module).items():
        if isinstance(value, Function) and value.__module__ == module.__name__:
            found.setdefault(id(value), (name, value))
    return dict(found.values())
