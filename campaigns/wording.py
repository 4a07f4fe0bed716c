"""How sentences write numbers and lists, the same in verdicts, stages and on the command line."""

from __future__ import annotations

from collections.abc import Sequence


def listed(names: Sequence[str]) -> str:
    """A, B and C; every name once."""
    names = list(dict.fromkeys(names))
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}" if names else "nothing"


def count(value: int) -> str:
    """A whole number, grouped by narrow no-break spaces."""
    return f"{value:,}".replace(",", "\u202f")


def number(value: float) -> str:
    """Six significant digits."""
    return f"{value:.6g}"


def signed(value: float) -> str:
    """Six significant digits with a sign."""
    return f"{value:+.6g}".replace("-", "\u2212")
