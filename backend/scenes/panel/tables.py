"""The tables of numbers in the viewer's panel, as HTML."""

from __future__ import annotations

import html
import math
from collections.abc import Sequence

from backend.scenes.base.setting import Setting
from backend.scenes.drawing import vectors
from backend.scenes.drawing.drawn import Drawn

_TABLE = (
    'style="width:calc(100% - 28px);margin:6px 18px 6px 10px;border-collapse:collapse;font-size:0.85em;'
    'font-variant-numeric:tabular-nums"'
)
_NUMBER = 'style="text-align:right;padding:2px 0 2px 8px"'
_HEAD = 'style="text-align:right;font-weight:500;opacity:0.7;padding:2px 0 2px 8px"'


def number(value: float | None, decimals: int) -> str:
    """Format with fixed decimals and a true minus sign, or a dash."""
    return "–" if value is None or not math.isfinite(value) else f"{value:.{decimals}f}".replace("-", "−")


def separations(drawn: Sequence[Drawn], setting: Setting, time: float) -> str:
    """Current separation, its minimum, and the margin of every visible flight."""
    values = [
        (one, (one.flight.at(time)[2], one.flight.cost, _margin(one, setting)))
        for one in drawn
        if one.flight is not None
    ]
    if not values:
        return note(f"No {setting.one} is stored yet.")
    first = 0 if setting.clears else 1  # the result of a simulator is not known over time
    rows = [_row(one, numbers[first:], setting.decimals) for one, numbers in values]
    heads = _heads(("now", setting.quantity or ("min" if setting.clears else "value"), "margin")[first:])
    return f"<table {_TABLE}><tr>{_unit(setting.unit)}{heads}</tr>{''.join(rows)}</table>"


def speeds(drawn: Sequence[Drawn], time: float, decimals: int) -> str:
    """Speed of every visible flight, over ground and relative to the nearest obstacle."""
    found = [(one, vectors.speeds(one, time)) for one in drawn if one.flight is not None]
    if not found:
        return ""
    rows = "".join(_row(one, at, decimals) for one, at in found)
    return f"<table {_TABLE}><tr>{_unit('m/s')}{_heads(('over ground', 'v rel'))}</tr>{rows}</table>"


def note(text: str, strong: bool = False) -> str:
    weight = "font-weight:600;" if strong else ""
    return f'<p style="{weight}margin:6px 10px;font-size:0.85em">{html.escape(text)}</p>'


def _unit(text: str) -> str:
    return f'<th style="text-align:left;font-weight:500;opacity:0.7">[{html.escape(text)}]</th>'


def _heads(texts: Sequence[str]) -> str:
    return "".join(f"<th {_HEAD}>{html.escape(text)}</th>" for text in texts)


def _margin(drawn: Drawn, setting: Setting) -> float | None:
    flight = drawn.flight
    return None if flight is None or flight.cost is None else flight.cost - setting.threshold


def _row(drawn: Drawn, values: Sequence[float | None], decimals: int) -> str:
    mark = f'<span style="color:{drawn.style.colour}">■</span> {html.escape(drawn.style.title)}'
    texts = [number(value, decimals) for value in values]
    cells = "".join(f"<td {_NUMBER}>{text} </td>" for text in texts)
    return f'<tr><td style="white-space:nowrap">{mark}</td>{cells}</tr>'
