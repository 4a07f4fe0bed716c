"""The panel's texts on the parameter space and on a repeated evaluation."""

from __future__ import annotations

import html

from backend.scenes.base.setting import Setting
from backend.scenes.cloud.evaluations import Cloud, Evaluation
from backend.scenes.drawing.colours import gradient
from backend.scenes.panel.tables import note, number
from campaigns.stored.replies import FlightReply

_TABLE = (
    'style="width:calc(100% - 28px);margin:6px 18px 6px 10px;border-collapse:collapse;font-size:0.85em;'
    'font-variant-numeric:tabular-nums"'
)


def legend(cloud: Cloud, setting: Setting, dark: bool) -> str:
    """The legend: colour scale with criterion, number of drawn evaluations, marks."""
    drawn, quantity = len(cloud.drawn), setting.quantity or "value"
    said = f"{drawn} of {cloud.total} evaluations" + (
        ", the lowest of every search among them." if drawn < cloud.total else "."
    )
    lost = [
        f"{sign} {word}: {cloud.count(*statuses)} of {count}"
        for sign, word, statuses, count in (
            ("✕", "failed", ("failed", "timeout"), cloud.failed),
            ("◇", "excluded", ("excluded",), cloud.excluded),
        )
        if count
    ]
    below = sum(one.cost is not None and one.cost <= setting.threshold for one in cloud.drawn)
    limit = f"At or below the criterion of {setting.threshold:g} {setting.unit}: {below} of those drawn."
    rest = " ".join([said, *(f"{text}." for text in lost), limit])
    balls = f"Balls: the nominal case and the findings. {hint(setting)}"
    return _scale(cloud, setting, quantity, dark) + note(rest) + note(balls)


def hint(setting: Setting) -> str:
    """What a click does."""
    return "Click a point to simulate it." if setting.clears else "Click a point for its stored values."


def _scale(cloud: Cloud, setting: Setting, quantity: str, dark: bool) -> str:
    if cloud.range is None:
        return note("No evaluation has a value yet.", strong=True)
    low, high = cloud.range
    share = (setting.threshold - low) / (high - low) if high > low else -1.0
    mark = ""
    if 0.0 <= share <= 1.0:
        mark = (
            f'<div title="criterion" style="position:absolute;left:{100 * share:.2f}%;top:-3px;bottom:-3px;'
            'border-left:2px dashed currentColor"></div>'
        )
    bar = f'<div style="position:relative;height:10px;border-radius:2px;background:{gradient(dark)}">{mark}</div>'
    ends = [number(low, setting.decimals), f"{number(high, setting.decimals)} {setting.unit}"]
    labels = "".join(f"<span>{html.escape(text)}</span>" for text in ends)
    where = "dashed" if mark else "below all of them" if setting.threshold < low else "not below any of them"
    return (
        f'<div style="margin:6px 10px;font-size:0.85em;font-variant-numeric:tabular-nums">{html.escape(quantity)}{bar}'
        f'<div style="display:flex;justify-content:space-between">{labels}</div>'
        f'<div style="opacity:0.7">criterion {setting.threshold:g} {html.escape(setting.unit)}: {where}</div></div>'
    )


def simulating(one: Evaluation) -> str:
    """The text while the clicked evaluation is simulated."""
    return _head(one) + note("Simulating it again …")


def stored(one: Evaluation, setting: Setting) -> str:
    """What is stored of the clicked evaluation of a simulator, at full precision; nothing is evaluated."""
    if one.cost is None:
        return _head(one) + note(f"{one.status.capitalize()}. {one.reason}".strip(), strong=True)
    margin = f"{one.cost - setting.threshold:.{setting.decimals}f} {setting.unit}".replace("-", "\u2212").strip()
    value = f"{setting.quantity or 'value'} = {one.cost!r} {setting.unit}".strip()
    return _head(one) + note(f"Stored: {value}, margin {margin}.", strong=True)


def outcome(one: Evaluation, answer: FlightReply, setting: Setting) -> str:
    """The stored and the repeated result at full precision, and whether they are identical."""
    stored = f"{one.cost!r} {setting.unit}" if one.cost is not None else one.status
    cost = answer["cost"]
    again = f"{cost!r} {setting.unit}" if cost is not None else f"{answer['status']}"
    rows = "".join(
        f'<tr><td>{head}</td><td style="text-align:right">{html.escape(text)}</td></tr>'
        for head, text in (("stored", stored), ("simulated again", again))
    )
    return f"{_head(one)}<table {_TABLE}>{rows}</table>" + note(_verdict(one, answer), strong=True)


def _verdict(one: Evaluation, answer: FlightReply) -> str:
    cost = answer["cost"]
    if one.cost is not None and cost is not None:
        if one.cost == cost:
            return "✓ Bit-identical."
        return f"✕ Not identical: they differ by {abs(cost - one.cost):.3g}."
    if one.status == answer["status"]:
        return f"✓ Identical: {answer['status']}. {answer['reason']}"
    return f"✕ Not identical. {answer['reason']}"


def _head(one: Evaluation) -> str:
    rows = "".join(
        f'<tr><td>{html.escape(path)}</td><td style="text-align:right">{value!r}</td></tr>'
        for path, value in one.parameters.items()
    )
    return note(f"Stage {one.stage}, evaluation {one.index} (from 0)", strong=True) + f"<table {_TABLE}>{rows}</table>"
