"""The types of values in a campaign: numbers, names, paths, parameter values, options, fractions.

Everything that can be validated for one value alone is validated here.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from decimal import Decimal
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field

from campaigns.documented import Documented

MAX_EVALUATIONS = 10_000_000
MAX_COUNTED = 1_000_000_000
"""Samples of which only the lowest are stored."""

LARGEST = 1e12
"""No quantity of a campaign may be larger than this, in its own unit."""

_DECIMAL = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?", re.ASCII)
_PERCENT = re.compile(r"\s*([-+0-9.eE]+)\s*%\s*", re.ASCII)
_CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f]")


class Strict(Documented):
    """A part of a campaign: immutable and without unknown fields."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


def _number(value: Any) -> float:
    """Numbers, and text that is a decimal number, because forms store the original text."""
    if isinstance(value, bool):
        raise ValueError("expected a number, given true or false")
    if isinstance(value, str):
        if not _DECIMAL.fullmatch(value.strip()):
            raise ValueError(f"expected a number, given {'text' if value.strip() else 'nothing'}")
        value = float(value)
    if not isinstance(value, int | float):
        raise ValueError("expected a number")
    if not abs(value) <= LARGEST:
        raise ValueError(f"expected a finite number of at most {LARGEST:g} in magnitude")
    return float(value) + 0.0  # -0.0 is 0.0: equal campaigns have equal digests


def _whole(value: Any) -> int:
    """A whole number, 100.0 and the text `100` included."""
    number = _number(value) if isinstance(value, str) else value
    if isinstance(number, bool) or not isinstance(number, int | float):
        raise ValueError("expected a whole number")
    if isinstance(number, float) and not number.is_integer():
        raise ValueError("expected a whole number")
    return int(number)


def _line(text: str) -> str:
    if not text.strip() or not text.isprintable():
        raise ValueError("expected one line of readable text")
    return text


def _text(text: str) -> str:
    if _CONTROL.search(text):
        raise ValueError("expected readable text without control characters")
    return text


AS_NUMBER = BeforeValidator(_number)
AS_WHOLE = BeforeValidator(_whole)
"""These come last, so that the limits before them apply to the number and appear in the JSON Schema."""
DISTINCT = AfterValidator(lambda entries: list(dict.fromkeys(entries)))
"""Each entry of a list counts once."""

Number = Annotated[float, AS_NUMBER]
Name = Annotated[str, Field(min_length=1, max_length=120), AfterValidator(_line)]
Notes = Annotated[str, Field(max_length=20_000), AfterValidator(_text)]
Summary = Annotated[str, Field(max_length=400), AfterValidator(_text)]
Source = Annotated[str, Field(max_length=300), AfterValidator(_text)]
Reason = Annotated[str, Field(min_length=1, max_length=300), AfterValidator(_line)]
Unit = Annotated[str, Field(max_length=30), AfterValidator(_text)]
Identifier = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$", max_length=60)]
Path = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*(\.[A-Za-z0-9_]+)+$", max_length=120)]
"""The path of a parameter in the scenario: `vehicle.m`, `obstacles.0.position.x`."""


def _share(value: Any) -> float | str:
    """A number, or a percentage in one spelling; both above 0."""
    if isinstance(value, str) and value.strip().endswith("%"):
        match = _PERCENT.fullmatch(value)
        try:
            share = _number(match[1]) if match else math.nan
        except ValueError:
            share = math.nan
        if not share > 0:
            raise ValueError("expected a number or a percentage such as 20%, above 0")
        return f"{share!r}".removesuffix(".0") + "%"
    try:
        amount = _number(value)
    except ValueError as error:
        raise ValueError(f"{error}; give a number or a percentage such as 20%") from None
    if not amount > 0:
        raise ValueError("expected a number or a percentage such as 20%, above 0")
    return amount


PlusMinus = Annotated[float | str, BeforeValidator(_share)]
"""`20%` is a fraction of the nominal value, `0.5` is in the parameter's unit."""


def around(nominal: float, plus_minus: float | str) -> tuple[float, float]:
    """Low and high around a nominal value, in its unit; computed in decimals: 20 % below 0.05 is 0.04."""
    middle = Decimal(repr(nominal))
    if isinstance(plus_minus, float):
        amount = Decimal(repr(plus_minus))
    else:
        amount = abs(middle) * Decimal(plus_minus.removesuffix("%")) / 100
    return float(middle - amount), float(middle + amount)


def _flatten(value: Any, prefix: str = "") -> Any:
    if not isinstance(value, Mapping):
        return value
    flat: dict[str, object] = {}
    for key, inner in value.items():
        more = _flatten(inner, f"{prefix}{key}.") if isinstance(inner, Mapping) else {f"{prefix}{key}": inner}
        if twice := flat.keys() & more.keys():
            raise ValueError(f"{min(twice)!r} is given twice, nested and with dots")
        flat.update(more)
    return flat


Values = Annotated[dict[str, Number], BeforeValidator(_flatten), Field(max_length=500)]
"""Parameter values by name; nested mappings are read as dotted names, `position: {x: 4}` as `position.x: 4`."""


def _option(value: Any) -> Any:
    """One setting of a method: a plain value or a list of them. 1.0 is 1, because JSON does not distinguish them."""
    if isinstance(value, list):
        if len(value) > 1000 or any(isinstance(v, list) for v in value):
            raise ValueError("expected a plain value or a list of at most 1000 of them")
        return [_option(v) for v in value]
    if isinstance(value, str):
        if len(value) > 1000:
            raise ValueError("expected text of at most 1000 characters")
        return _text(value)
    if value is None or isinstance(value, bool):
        return value
    if not isinstance(value, int | float):
        raise ValueError("expected a number, text, true, false, null or a list of them")
    if not abs(value) <= LARGEST:
        raise ValueError(f"expected a finite number of at most {LARGEST:g} in magnitude")
    return int(value) if float(value).is_integer() else value


Option = Annotated[Any, BeforeValidator(_option)]
