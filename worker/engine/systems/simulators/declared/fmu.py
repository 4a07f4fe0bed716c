"""Reads the descriptor of an FMU that is a simulator: `simulator.yaml` with the key `fmu`.

Names, units, limits and start values come from the model; the descriptor (`fmu_descriptor`) states what the model does
not. docs/your-own-simulator.md shows one.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from campaigns.catalogue import ParameterEntry, ResultEntry, SimulatorEntry
from worker.engine.systems.simulators.declared.columns import TIME, Column
from worker.engine.systems.simulators.declared.described import Described
from worker.engine.systems.simulators.declared.fmu_descriptor import FmuDescriptor, FmuParameter, FmuResult
from worker.engine.systems.simulators.declared.fmu_model import REALS, Model, Unusable, Variable, model

STEPS = 10_000_000
CELLS = 500_000
"""Values of a trace, rows times columns, that an answer of 16 MB can hold with all digits."""
ROWS = 100_000
"""Of a trace."""
STEP = "communication step"
"""The name of the step of every FMU."""


@dataclass(frozen=True)
class Input:
    """A number that every evaluation sets."""

    variable: Variable
    entry: ParameterEntry


@dataclass(frozen=True)
class DescribedFmu(Described):
    """The descriptor of an FMU, completed by its model; sha256: of the file."""

    descriptor: FmuDescriptor
    model: Model
    sha256: str
    stop: float
    step: float
    inputs: tuple[Input, ...]
    recorded: dict[str, Variable]
    """The variables of a trace by column, without time."""

    @property
    def columns(self) -> dict[str, Column]:
        if not self.recorded:
            return {}
        found = {TIME: Column("s")}
        for name, variable in self.recorded.items():
            stated = self.descriptor.trace[name]
            text = variable.text if stated.text is None else stated.text
            found[name] = Column(variable.unit or stated.unit or "", text, stated.symbol)
        return found

    @property
    def every(self) -> int:
        """A trace has each communication point of this number, so that it is not too long, and the last one."""
        most = min(ROWS, CELLS // (1 + len(self.recorded)))
        return -(-self.steps // (most - 1))

    @property
    def file(self) -> Path:
        return self.folder / self.descriptor.fmu

    @property
    def steps(self) -> int:
        return round((self.stop - self.model.start) / self.step)

    @property
    def entry(self) -> SimulatorEntry:
        d = self.descriptor
        return SimulatorEntry(
            name=d.name,
            title=d.title or d.name,
            text=d.text or self.model.text,
            parameters=[each.entry for each in self.inputs],
            results=[_result(name, r, self.model.variables[r.variable]) for name, r in d.results.items()],
            step=STEP,
        )


def read(folder: Path, document: dict[str, object]) -> DescribedFmu:
    """The described FMU of a folder; raises ValidationError and Unusable."""
    if "command" in document:
        raise Unusable("command: not together with fmu; give one of the two")
    descriptor = FmuDescriptor.model_validate(document)
    file = folder / descriptor.fmu
    if not file.is_file():
        raise Unusable(f"fmu: there is no file {descriptor.fmu} in {folder}")
    sha256 = hashlib.sha256(file.read_bytes()).hexdigest()
    found = model(file, sha256)
    for name, result in descriptor.results.items():
        variable = _readable(f"results.{name}", result.variable, found, descriptor.fmu)
        _unit(f"results.{name}.unit", result.unit, "s" if result.take == "first_crossing" else variable.unit)
    inputs = tuple(_named(descriptor, found) if descriptor.parameters else _all(descriptor, found))
    _fixed(descriptor, found, {each.variable.reference for each in inputs})
    stop, step = _times(descriptor, found)
    recorded = dict(_recorded(descriptor, found))
    described = DescribedFmu(folder, descriptor, found, sha256, stop, step, inputs, recorded)
    try:
        _ = described.drawn
    except ValueError as error:
        raise Unusable(str(error)) from None
    return described


def _recorded(descriptor: FmuDescriptor, found: Model) -> Iterator[tuple[str, Variable]]:
    for name, stated in descriptor.trace.items():
        if name == TIME:
            raise Unusable("trace.time: the time of the communication points is added by itself; remove it")
        wanted = stated.variable or name
        variable = _readable(f"trace.{name}", wanted, found, descriptor.fmu)
        _unit(f"trace.{name}.unit", stated.unit, variable.unit)
        yield name, variable


def _times(descriptor: FmuDescriptor, found: Model) -> tuple[float, float]:
    """End and communication step [s], of which the duration is a whole multiple."""
    stop = found.stop if descriptor.stop is None else descriptor.stop
    step = found.step if descriptor.step is None else descriptor.step
    for key, value in (("stop", stop), ("step", step)):
        if value is None:
            raise Unusable(f"{key}: the model states none; give it in seconds")
    assert stop is not None
    assert step is not None
    if stop <= found.start:
        raise Unusable(f"stop: {stop:g} s must be after the start of the model, {found.start:g} s")
    if step <= 0:
        raise Unusable(f"step: the model states {step:g} s; give a positive one")
    steps = (stop - found.start) / step
    if steps > STEPS:
        raise Unusable(f"step: {steps:.3g} steps of {step:g} s; at most {STEPS} are allowed")
    if round(steps) < 1 or abs(steps - round(steps)) > 1e-6:
        text = f"step: {stop - found.start:g} s are {steps:.6g} steps of {step:g} s; a whole number is expected"
        raise Unusable(text)
    return stop, step


def _all(descriptor: FmuDescriptor, found: Model) -> Iterator[Input]:
    """Every parameter and input that is a real number and not fixed."""
    chosen: dict[str, Variable] = {}
    for variable in found.variables.values():
        alias = variable.reference in {v.reference for v in chosen.values()}
        if not variable.settable or variable.name in descriptor.fixed or alias:
            continue
        name = identifier(variable.name)
        if name in chosen:
            both = f"{chosen[name].name} and {variable.name}"
            raise Unusable(f"parameters: {both} would both be called {name}; name those that a campaign may vary")
        chosen[name] = variable
    if not chosen:
        raise Unusable(f"parameters: {descriptor.fmu} has no parameter and no input that is a real number")
    unlimited = [n for n, v in chosen.items() if v.low is None or v.high is None or v.start is None]
    if unlimited:
        raise Unusable(
            f"parameters: the model states no finite min and max, or no start value, of {_some(unlimited)}; list the"
            " parameters that a campaign may vary, with low, high and nominal where the model states none"
        )
    for name, variable in chosen.items():
        yield _input(name, FmuParameter(), variable)


def _named(descriptor: FmuDescriptor, found: Model) -> Iterator[Input]:
    taken: dict[int, str] = {}
    for name, stated in (descriptor.parameters or {}).items():
        variable = _meant(name, stated, found, descriptor.fmu)
        if variable.reference in taken:  # also by an alias
            first = taken[variable.reference]
            raise Unusable(f"parameters.{name}: {first} already sets this variable; remove one of them")
        taken[variable.reference] = name
        yield _input(name, stated, variable)


def _meant(name: str, stated: FmuParameter, found: Model, file: str) -> Variable:
    wanted = stated.variable or name
    alike = [v for v in found.variables.values() if identifier(v.name) == wanted] if stated.variable is None else []
    variable = found.variables.get(wanted) or (alike[0] if len(alike) == 1 else None)
    if variable is None:
        settable = [v.name for v in found.variables.values() if v.settable]
        raise Unusable(f"parameters.{name}: {file} has no variable {wanted}; it has {_some(settable)}")
    if not variable.settable:
        shape = "one" if variable.scalar else "an array"
        raise Unusable(
            f"parameters.{name}: {variable.name} is {shape} {variable.type}, causality {variable.causality},"
            f" variability {variable.variability}; one real number is expected, a fixed or tunable parameter or input"
        )
    return variable


def _input(name: str, stated: FmuParameter, variable: Variable) -> Input:
    nominal = variable.start if stated.nominal is None else stated.nominal
    low = variable.low if stated.low is None else stated.low
    high = variable.high if stated.high is None else stated.high
    if nominal is None or low is None or high is None:
        numbers = {"nominal": nominal, "low": low, "high": high}
        missing = " and ".join(key for key, value in numbers.items() if value is None)
        raise Unusable(f"parameters.{name}: the model states no finite value for {missing}; give it here")
    if not low <= nominal <= high:
        raise Unusable(f"parameters.{name}: nominal {nominal:g} must be within [low {low:g}, high {high:g}]")
    unit = _unit(f"parameters.{name}.unit", stated.unit, variable.unit)
    text = variable.text if stated.text is None else stated.text
    entry = ParameterEntry(
        name=name, symbol=stated.symbol, unit=unit, low=low, high=high, default=nominal, text=text
    )  # fmt: skip
    return Input(variable, entry)


def _readable(key: str, name: str, found: Model, file: str) -> Variable:
    """The variable of that name, which is one real number."""
    variable = found.variables.get(name)
    if variable is None:
        reals = [v.name for v in found.variables.values() if v.type in REALS and v.causality == "output"]
        raise Unusable(f"{key}.variable: {file} has no variable {name}; its outputs are {_some(reals)}")
    if variable.type not in REALS or not variable.scalar:
        kind = variable.type if variable.scalar else f"an array of {variable.type}"
        raise Unusable(f"{key}.variable: {name} is {kind}; one real number is expected")
    return variable


def _result(name: str, result: FmuResult, variable: Variable) -> ResultEntry:
    return ResultEntry(
        name=name,
        title=result.title or name,
        quantity=result.quantity or name,
        unit=_unit(name, result.unit, "s" if result.take == "first_crossing" else variable.unit),
        worse=result.worse,
        text=variable.text if result.text is None else result.text,
    )


def _fixed(descriptor: FmuDescriptor, found: Model, varied: set[int]) -> None:
    """Check the values under `set` by the types of their variables."""
    kinds: dict[str, tuple[type, ...]] = {"Boolean": (bool,), "String": (str,)}
    kinds |= dict.fromkeys(("Real", "Float32", "Float64"), (int, float))
    for name, value in descriptor.fixed.items():
        variable = found.variables.get(name)
        if variable is None:
            raise Unusable(f"set.{name}: {descriptor.fmu} has no variable of this name")
        if variable.type in REALS and variable.reference in varied:
            raise Unusable(f"set.{name}: it is a parameter of the simulator; remove it here or under parameters")
        if variable.causality not in ("parameter", "input") or not variable.scalar:
            raise Unusable(f"set.{name}: it is {variable.causality}; a scalar parameter or input is expected")
        expected = kinds.get(variable.type, (int,))
        if not isinstance(value, expected) or (isinstance(value, bool) and bool not in expected):
            raise Unusable(f"set.{name}: {value!r:.60} is not a value of type {variable.type}")


def _unit(key: str, stated: str | None, modelled: str) -> str:
    if stated is not None and modelled and stated != modelled:
        raise Unusable(f"{key}: the model states {modelled}, not {stated}; values are in {modelled}: remove this")
    return modelled or stated or ""


def identifier(name: str) -> str:
    """The name of a variable in campaigns: `body.m[1]` is `body_m_1`."""
    plain = re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")
    return (plain if plain[:1].isalpha() else f"p_{plain}")[:60]


def _some(names: list[str]) -> str:
    return ", ".join(names[:12]) + (", ..." if len(names) > 12 else "") if names else "none"
