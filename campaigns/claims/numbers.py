"""How numbers and units are written: as plain text, and in print. Each format exists once.

Plain: significant digits, a full space before the unit, as on the command line. In print: true minus sign, narrow space
before the unit, units with dots and superscripts, as in reports and on the pages. `frontend/src/format` writes the same
texts: `frontend/tests/numbers.json` has the cases of both tests. Start reading at `written`.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterable
from decimal import ROUND_CEILING, ROUND_FLOOR, ROUND_HALF_EVEN, Context, Decimal
from enum import StrEnum

MINUS, NARROW, NONE = "\u2212", "\u202f", "\u2014"
_RAISED = {"2": "²", "3": "³", "4": "⁴"}


class Format(StrEnum):
    """How a number is written."""

    PLAIN = "plain"
    """Significant digits."""
    SIGNED = "signed"
    """The same with its sign: margins and differences."""
    COUNT = "count"
    """A whole number, grouped by narrow spaces."""
    PERCENT = "percent"
    """A fraction as percent."""
    PROBABILITY = "probability"
    """A fraction as percent, below 0.01 % as a power of ten."""
    AT_MOST = "at_most"
    """The same of an upper bound: rounded up, never below itself."""
    AT_LEAST = "at_least"
    """The same of a lower bound: rounded down."""
    LOWEST = "lowest"
    """A lower bound that is no probability: significant digits, rounded down."""


ROUNDED = {
    Format.PROBABILITY: ROUND_HALF_EVEN,
    Format.AT_MOST: ROUND_CEILING,
    Format.AT_LEAST: ROUND_FLOOR,
}
MOST_DECIMALS = 20
RARE = Decimal("1e-4")
"""Probabilities below it are written as powers of ten."""
ALL = 1 - 1e-12
"""A fraction from here on is read as all: the sum of shares may be 1 but for rounding."""


def written(value: float, unit: str = "", form: Format = Format.PLAIN, digits: int = 6) -> str:
    """A number with its unit as plain text."""
    value += 0.0  # no negative zero
    if form is Format.PERCENT:
        return f"{_percent(value, digits)} %"
    if form in ROUNDED:
        return _probability(value, form, digits)
    text = {
        Format.PLAIN: lambda: f"{value:.{digits}g}",
        Format.LOWEST: lambda: f"{float(rounded(value, Format.AT_LEAST, digits)):.{digits}g}",
        Format.SIGNED: lambda: f"{value:+.{digits}g}".replace("-", MINUS),
        Format.COUNT: lambda: f"{round(value):,}".replace(",", NARROW),
    }[form]()
    return f"{text} {unit}" if unit else text


def printed(value: float, unit: str = "", form: Format = Format.PLAIN, digits: int = 6) -> str:
    """The number with the digits that pages and reports print."""
    text = written(value, "", form, digits).replace("-", MINUS)
    if form is Format.PERCENT or form in ROUNDED:
        return text.replace(" ", NARROW)
    return f"{text}{NARROW}{unit_in_print(unit)}" if unit else text


def rounded(value: float, form: Format, digits: int) -> Decimal:
    """A number as a probability of this format is written, rounded once.

    By the digits of the shortest decimal number that is this float: 0.05 rounded up stays 0.05.
    """
    return Context(prec=digits, rounding=ROUNDED[form]).plus(Decimal(repr(float(value))))


def digits_of(value: float, least: int = 6) -> int:
    """The significant digits, at least so many, that a threshold needs to be read as it is."""
    return next((n for n in range(least, 17) if float(f"{value:.{n}g}") == value), 17)


def digits_beside(value: float, threshold: float, least: int = 6, form: Format = Format.PLAIN) -> int:
    """The significant digits, at least so many, with which a value is read on its own side of a threshold."""

    def read(digits: int) -> float:
        return float(rounded(value, form, digits) if form in ROUNDED else f"{value:.{digits}g}")

    return next((n for n in range(least, 17) if _side(read(n), threshold) == _side(value, threshold)), 17)


def decimals_beside(values: Iterable[float | None], threshold: float, least: int) -> int:
    """The decimals, at least so many, with which each value is read on its own side of a threshold."""

    def needed(value: float) -> int:
        places = range(least, MOST_DECIMALS + 1)
        return next((n for n in places if _side(round(value, n), threshold) == _side(value, threshold)), least)

    return max((needed(value) for value in values if value is not None and known(value)), default=least)


def _side(value: float, threshold: float) -> tuple[bool, bool]:
    return value < threshold, value > threshold


def digits_between(low: float, high: float, least: int = 6) -> int:
    """The significant digits, at least so many, with which bounds claim no wider interval than they are.

    Low is written no lower and high no higher, but for rounding of the last bits, as a conversion of units leaves it;
    and the interval is written no narrower by more than 1e-9 of it.
    """
    bits = 4 * math.ulp(max(abs(low), abs(high)))
    inside = max(1e-9 * (high - low), bits)

    def fits(digits: int) -> bool:
        first, last = (float(f"{v:.{digits}g}") for v in (low, high))
        return -bits <= first - low <= inside and -bits <= high - last <= inside

    return next((n for n in range(least, 17) if fits(n)), 17)


def interval(low: float, high: float) -> str:
    """Bounds as text, never wider than they are."""
    return f"{between(low, low, high)} to {between(high, low, high)}"


def between(value: float, low: float, high: float) -> str:
    """The value of a parameter with so many digits that it is read within its bounds, and apart from them."""
    return written(value, digits=digits_between(low, high))


def limit(threshold: float) -> str:
    """A threshold with all digits that it needs."""
    return written(threshold, digits=digits_of(threshold))


def beside(value: float, threshold: float) -> str:
    """A value with so many digits that it is read on its own side of a threshold."""
    return written(value, digits=digits_beside(value, threshold))


def number(value: float) -> str:
    """The number with six significant digits."""
    return written(value)


def signed(value: float) -> str:
    """Six significant digits with a sign."""
    return written(value, form=Format.SIGNED)


def count(value: float | None) -> str:
    """A whole number, grouped; a dash if unknown."""
    return fixed(value, 0)


def known(value: object) -> bool:
    """Whether this is a finite number."""
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def fixed(value: float | None, decimals: int = 2) -> str:
    """A number in print with `decimals` decimals; a dash if unknown."""
    if value is None or not known(value):
        return NONE
    text = f"{abs(value):,.{min(max(decimals, 0), MOST_DECIMALS)}f}".replace(",", NARROW)
    negative = value < 0 and any(c in "123456789" for c in text)
    return (MINUS if negative else "") + text


def difference(value: float | None, decimals: int = 2) -> str:
    """Write a number as `fixed` does, with a plus before positive ones."""
    text = fixed(value, decimals)
    return f"+{text}" if value is not None and value > 0 and any(c in "123456789" for c in text) else text


def margin(value: float | None, decimals: int = 2) -> str:
    """Write a margin as `difference` does, but never as zero if it is not: its sign is what counts."""
    text = difference(value, decimals)
    if value is None or not known(value) or value == 0 or any(c in "123456789" for c in text):
        return text
    return ("+" if value > 0 else "") + plain(value, 2)


def decimals_for(values: Iterable[float | None], digits: int = 4) -> int:
    """The decimals at which the largest of these numbers has `digits` significant digits."""
    largest = max((abs(v) for v in values if v is not None and known(v)), default=0.0)
    if largest == 0:
        return max(0, digits - 1)
    return min(12, max(0, digits - 1 - math.floor(math.log10(largest) + 1e-12)))


def decimals_apart(values: Iterable[float | None], digits: int = 4, most: int = 7) -> int:
    """The decimals that show these numbers and still distinguish the nearest two."""
    ordered = sorted(v for v in values if v is not None and known(v))
    scale = max((abs(v) for v in ordered), default=0.0)
    gaps = [b - a for a, b in itertools.pairwise(ordered) if b - a > 1e-9 * scale]
    base = decimals_for(ordered, digits)
    if not gaps:
        return base
    return min(max(base, math.ceil(-math.log10(min(gaps)) - 0.01)), decimals_for(ordered, most))


def exact(value: float | None) -> str:
    """Write a threshold as `plain` does, with all digits: nothing is compared with what it is not."""
    if value is None or not known(value):
        return NONE
    text = repr(abs(float(value)))
    if value == 0 or "e" in text or not 1e-4 <= abs(value) < 1e9:
        return plain(value, digits_of(value))
    return fixed(value, len(text.partition(".")[2].rstrip("0")))


def plain(value: float | None, digits: int = 6) -> str:
    """A number in a table: significant digits, no trailing zeros, grouped, powers of ten at the ends."""
    if value is None or not known(value):
        return NONE
    if value == 0:
        return "0"
    size = abs(value)
    if size >= 1e9 or size < 1e-4:
        mantissa, _, power = f"{size:.{digits - 1}e}".partition("e")
        text = f"{_trimmed(mantissa)}e{int(power)}".replace("-", MINUS)
    else:
        exponent = int(f"{size:.{digits - 1}e}".partition("e")[2])  # of the rounded number: 0.9999996 may be 1
        text = _trimmed(fixed(size, digits - 1 - exponent))
    return (MINUS if value < 0 else "") + text


def duration(value: float | None) -> str:
    """A length of time [s]: 23.4 s, 1:25 min, 2 h 01 min.

    Rounded to the nearest of the last unit shown, once: cut off, every time would read too short, by up to a minute;
    rounded twice, 61 min 29.6 s would become 62. The unit follows from the rounded time: never 60.0 s or 60:00 min.
    """
    if value is None or not known(value):
        return NONE
    if round(value, 1) < 60:
        return f"<{NARROW}0.1{NARROW}s" if value < 0.05 else f"{value:.1f}{NARROW}s"
    minutes, rest = divmod(round(value), 60)
    if minutes < 60:
        return f"{minutes}:{rest:02d}{NARROW}min"
    hours, minutes = divmod(round(value / 60), 60)
    return f"{hours}{NARROW}h{NARROW}{minutes:02d}{NARROW}min"


def unit_in_print(text: str) -> str:
    """kg m2 as kg·m²."""
    raised = re.sub(r"([A-Za-zµΩ°])\^?([234])(?!\d)", lambda m: m[1] + _RAISED[m[2]], text)
    return re.sub(r"(?<=\S) (?=\S)", "·", raised)


def _percent(value: float, digits: int) -> str:
    """Significant digits, and as many as tell less than all from all; a power of ten only from 10,000 on."""
    for more in range(digits, 18):
        text = f"{100 * value:.{more}g}"
        if float(text) != 100 or value >= ALL:
            break
    return f"{float(text):.0f}" if abs(float(text)) < 10_000 and "e+" in text else text


def _probability(value: float, form: Format, digits: int) -> str:
    """Significant digits; no bound, also as many as tell less than all from all."""
    if form is Format.PROBABILITY and abs(value) < ALL:
        digits = digits_beside(abs(value), 1.0, digits, form)
    size = rounded(value, form, digits)
    if size == 0 or abs(size) >= RARE:
        return f"{_trimmed(f'{size.scaleb(2):f}')} %"
    mantissa, _, power = f"{size:.{max(digits - 1, 1)}e}".partition("e")
    mantissa = _trimmed(mantissa)
    return f"{mantissa if '.' in mantissa else mantissa + '.0'}e{int(power)}"


def _trimmed(digits: str) -> str:
    return digits.rstrip("0").rstrip(".") if "." in digits else digits
