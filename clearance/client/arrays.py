"""Evaluations, traces and findings as numpy arrays and as tables of pandas."""

from __future__ import annotations

import csv
import importlib
import io
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clearance.client import answers

Floats = NDArray[np.float64]
_DRAW = "draw"
_FIXED = ("stage", "kind", "method", "index", "status", "reason", "seconds")
"""The first columns of evaluations.csv; then come the criteria, the parameters, and of some runs `_DRAW`."""


def table(columns: Mapping[str, Any]) -> Any:
    """A pandas DataFrame; raises ImportError with a sentence if pandas is not installed."""
    try:
        pandas = importlib.import_module("pandas")
    except ImportError:
        raise ImportError(
            "to_dataframe needs pandas, which is not installed: pip install pandas; "
            "the attributes have the same data as arrays"
        ) from None
    return pandas.DataFrame(dict(columns))


@dataclass(frozen=True, eq=False, repr=False)
class Evaluations:
    """Every stored evaluation of a run: m evaluations of n parameters, k criteria.

    names (n,): paths of the parameters; units: by path or criterion. points (m, n): parameters in their units,
    bit-identical to those that were simulated. criteria (k,): names; values (m, k): in their units, NaN unless the
    status is "ok"; costs (m,): of the deciding criterion, the first. status (m,): "ok", "failed", "timeout" or
    "excluded". stage (m,): position; kind (m,): "nominal", "search", ...; method (m,): empty for other stages than
    searches. index (m,): in its stage. seconds (m,): working time of the stage when each was completed [s]. reasons:
    why there is no value, by row. draw (m,): which draw of its sample it is where only a part of the sample is stored,
    which then is not every evaluation; -1 elsewhere.
    """

    names: tuple[str, ...]
    criteria: tuple[str, ...]
    units: Mapping[str, str]
    points: Floats
    values: Floats
    status: NDArray[np.str_]
    stage: NDArray[np.int64]
    kind: NDArray[np.str_]
    method: NDArray[np.str_]
    index: NDArray[np.int64]
    seconds: Floats
    reasons: Mapping[int, str]
    draw: NDArray[np.int64]

    @property
    def costs(self) -> Floats:
        """(m,): of the deciding criterion [its unit]."""
        return self.values[:, 0]

    @staticmethod
    def of(content: bytes, run: answers.RunDetail) -> Evaluations:
        """The arrays of evaluations.csv; raises ValueError if it has other columns."""
        heads, *rows = csv.reader(io.StringIO(content.decode("utf-8"), newline=""))
        named = [_split(head) for head in heads]
        uncertain = run.campaign["uncertain"]
        last = len(named) - (heads[-1] == _DRAW)
        first = last - len(uncertain)
        names = tuple(name for name, _ in named[first:last])
        if (
            tuple(name for name, _ in named[: len(_FIXED)]) != _FIXED
            or first <= len(_FIXED)
            or sorted(names) != sorted(uncertain)
        ):
            raise ValueError(f"evaluations.csv of {run.id} has unexpected columns: {', '.join(heads)}")
        by_column = list(zip(*rows, strict=True)) if rows else [()] * len(named)
        stage, kind, method, index, status, reason, seconds = by_column[: len(_FIXED)]
        draws = by_column[-1] if last < len(named) else [""] * len(rows)
        return Evaluations(
            names=names,
            criteria=tuple(name for name, _ in named[len(_FIXED) : first]),
            units={name: unit for name, unit in named[len(_FIXED) :] if unit},
            points=_floats(by_column[first:last], len(rows)),
            values=_floats(by_column[len(_FIXED) : first], len(rows)),
            status=_fixed(np.array(status, dtype=np.str_)),
            stage=_fixed(np.array(stage, dtype=np.int64)),
            kind=_fixed(np.array(kind, dtype=np.str_)),
            method=_fixed(np.array(method, dtype=np.str_)),
            index=_fixed(np.array(index, dtype=np.int64)),
            seconds=_floats([seconds], len(rows))[:, 0],
            reasons={row: text for row, text in enumerate(reason) if text},
            draw=_fixed(np.array([int(text or -1) for text in draws], dtype=np.int64)),
        )

    def to_dataframe(self) -> Any:
        """A data frame with a row for each evaluation; our columns whose names are taken end with `_`. Needs pandas."""
        columns: dict[str, Any] = dict(zip(self.names, self.points.T, strict=True))
        reasons = np.array([self.reasons.get(k, "") for k in range(len(self.points))], dtype=object)
        own = dict(zip(self.criteria, self.values.T, strict=True))
        own |= {name: getattr(self, name) for name in ("status", "stage", "kind", "method", "index", "seconds", "draw")}
        for name, column in (own | {"reason": reasons}).items():
            columns[name + "_" * (name in columns)] = column
        return table(columns)

    def __repr__(self) -> str:
        failed = int((self.status != "ok").sum())
        return f"<{len(self.points)} evaluations of {', '.join(self.names)}; {failed} without a value>"


@dataclass(frozen=True, eq=False, repr=False)
class Trace:
    """Quantities over time of one case: arrays (rows,) by name, NaN where there is no value; units by name.

    complete: false if the service has more rows than are here.
    """

    name: str
    data: Mapping[str, Floats]
    units: Mapping[str, str]
    complete: bool

    @staticmethod
    def of(answer: answers.TraceData) -> Trace:
        """The trace from the answer of the service."""
        data = {c.name: _fixed(np.array(answer.data[c.name], dtype=np.float64)) for c in answer.columns}
        here = len(next(iter(data.values()), ()))
        return Trace(answer.name, data, {c.name: c.unit for c in answer.columns if c.unit}, here == answer.rows)

    def __getitem__(self, name: str) -> Floats:
        return self.data[name]

    def to_dataframe(self) -> Any:
        """A data frame with a row for each instant. Needs pandas."""
        return table(self.data)

    def __repr__(self) -> str:
        rows = len(next(iter(self.data.values()), ()))
        return f"<Trace {self.name}: {rows} rows of {', '.join(self.data)}>"


class Findings(list[answers.Finding]):
    """The distinct worst cases, the lowest first."""

    def to_dataframe(self) -> Any:
        """A data frame with a row for each finding: label, cost, margin, methods, how likely it is, and each parameter.

        `cost` and `margin` are those that the verdict states, `evaluated` is the value that the search saw. `distance`,
        `density` and `tail` are those of its likelihood, NaN where it has none. Needs pandas.
        """
        paths = dict.fromkeys(path for finding in self for path in finding.parameters)
        stated = [f.cost if f.granted is None else f.granted for f in self]
        columns: dict[str, Any] = {"label": [f.label for f in self], "cost": stated}
        columns["margin"] = [f.margin for f in self]
        columns["evaluated"] = [f.cost for f in self]
        columns["methods"] = [" ".join(f.methods) for f in self]
        for name in ("distance", "density", "tail"):
            found = [None if f.likelihood is None else getattr(f.likelihood, name) for f in self]
            columns[name] = [np.nan if value is None else value for value in found]
        return table(columns | {path: [f.parameters.get(path, np.nan) for f in self] for path in paths})


def _split(head: str) -> tuple[str, str]:
    """Name and unit of a header, `vehicle.m [kg]`."""
    name, bracket, unit = head.rpartition(" [")
    return (name, unit.removesuffix("]")) if bracket and unit.endswith("]") else (head, "")


def _floats(columns: Any, rows: int) -> Floats:
    """The columns as (rows, columns); empty texts are NaN."""
    made = np.empty((rows, len(columns)))
    for k, column in enumerate(columns):
        made[:, k] = [float(text) if text else np.nan for text in column]
    fixed: Floats = _fixed(made)
    return fixed


def _fixed(array: Any) -> Any:
    array.flags.writeable = False
    return array
