"""Typed parameters of a component, declared as the fields of a NamedTuple: unit, limits and text.

`declared` returns them as data.
"""

from __future__ import annotations

import re
import typing
from collections import namedtuple
from dataclasses import dataclass, replace
from typing import Annotated, Any


@dataclass(frozen=True)
class Parameter:
    """One number of a component: unit, one line of text, and the limits of meaningful values.

    `name` is its name in a campaign if that differs from the field's, such as `position.x` for `position_x`.
    """

    unit: str
    text: str
    low: float = -1e9
    high: float = 1e9
    symbol: str = ""
    name: str = ""


@dataclass(frozen=True)
class Order:
    """The product of the parameters `low` is below `times` that of `high`, or `equal` to it; a name given twice is a
    square. A campaign whose bounds allow anything else is refused with `text`: why, or what to do.

    Order(("u_min",), ("u_max",), "lower u_min or raise u_max")
    """

    low: tuple[str, ...]
    high: tuple[str, ...]
    text: str
    times: float = 1.0
    equal: bool = True


@dataclass(frozen=True)
class Declared:
    """A declared parameter: field of the NamedTuple, name in a campaign, ...; it is required if `default` is None."""

    field: str
    name: str
    symbol: str
    unit: str
    text: str
    low: float
    high: float
    default: float | None


def declared(fields: type) -> tuple[Declared, ...]:
    """The parameters of a NamedTuple whose fields are `Annotated[float, Parameter(...)]`, in order."""
    hints = typing.get_type_hints(fields, include_extras=True)
    defaults = getattr(fields, "_field_defaults", {})
    found = []
    for field, hint in hints.items():
        meta = next((m for m in getattr(hint, "__metadata__", ()) if isinstance(m, Parameter)), None)
        if meta is None:
            raise TypeError(f"{fields.__name__}.{field} needs Annotated[float, Parameter(unit, text, ...)]")
        default = defaults.get(field)
        if not meta.low < meta.high or (default is not None and not meta.low <= default <= meta.high):
            raise TypeError(
                f"{fields.__name__}.{field}: low {meta.low} must be below high {meta.high}, "
                f"and the default ({default}) within them"
            )
        found.append(
            Declared(
                field, meta.name or field, meta.symbol or field, meta.unit, meta.text, meta.low, meta.high, default
            )
        )
    return tuple(found)


def extended(name: str, *parts: type) -> Any:
    """A NamedTuple with the fields and declarations of several, in order; with defaults if every field has one."""
    fields = [field for part in parts for field in part._fields]  # type: ignore[attr-defined]
    defaults = [v for part in parts for v in part._field_defaults.values()]  # type: ignore[attr-defined]
    made: Any = namedtuple(name, fields, defaults=defaults if len(defaults) == len(fields) else ())  # type: ignore[misc]
    hints = [typing.get_type_hints(part, include_extras=True) for part in parts]
    made.__annotations__ = {field: hint for part in hints for field, hint in part.items()}
    return made


_Y = re.compile(r"(?<![a-z])y(?![a-z])")


def in_space(planar: Any, **defaults: float) -> Any:
    """The parameters in space: a z like it follows every y; with these defaults in place of the planar ones."""
    hints: dict[str, Any] = {}
    values = planar._field_defaults | defaults
    for field, hint in typing.get_type_hints(planar, include_extras=True).items():
        hints[field] = hint
        third = _Y.sub("z", field)
        if third != field:
            (y,) = hint.__metadata__
            named = {key: _Y.sub("z", getattr(y, key)) for key in ("text", "symbol", "name")}
            hints[third] = Annotated[float, replace(y, **named)]
            values |= {third: values[field]} if field in values else {}
    defaulted = [values[field] for field in hints if field in values]
    made: Any = namedtuple(planar.__name__, hints, defaults=defaulted)  # type: ignore[misc]
    made.__annotations__ = hints
    return made


def text_in_space(planar: str | None, more: str = "") -> str:
    """The text of a planar component for the one that is derived from it, with a last line of its own."""
    text = (planar or "").replace("in the plane", "in space").replace("Circle", "Sphere")
    return f"{text.rstrip()}\n{more}".rstrip() + "\n"
