"""A result as text for a terminal and as HTML for a notebook: verdict, sentence, findings, convergence.

The HTML has no script, and no colour that only one theme can show: text has the colour of the notebook.
"""

from __future__ import annotations

import textwrap
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from campaigns.claims.numbers import beside, between, count, limit, signed
from clearance.local.citation import lines as citing
from worker.running.catalogue.installed import methods

if TYPE_CHECKING:
    from clearance.function.result import Result

COLOURS = {"cleared": "#009e73", "violated": "#d55e00", "inconclusive": "#e69f00"}
ICONS = {"cleared": "✓", "violated": "✗", "inconclusive": "?"}
LINES = ("#3f9bdb", "#c66aa5", "#1fae85", "#d98032", "#8f7bd0", "#9a9a9a")
"""Of the methods: each can be read on white and on black."""
WIDTH, HEIGHT, LEFT, BOTTOM, TOP, RIGHT = 560, 190, 74, 38, 10, 30
Line = tuple[str, Any, Any]
"""A method, its evaluations (k,), and its best values so far (k,)."""
MOST = 200
"""Points of a line."""


def text(result: Result) -> str:
    """The result as text for a terminal; sentences are wrapped at 100 characters."""
    verdict = result.verdict
    lines = [f"{ICONS[verdict]} {verdict.capitalize()}", *textwrap.wrap(verdict.sentence, 100), *_cites(result), ""]
    rows = _rows(result)
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    lines += [_line(row, widths) for row in rows]
    for check in verdict.checks:
        if check.standing != "holds":
            lines += ["", *textwrap.wrap(f"{check.title}: {check.text}", 100)]
    if verdict.sureness is not None:
        lines += ["", *textwrap.wrap(verdict.sureness.text, 100)]
    if failed := _failed(result):
        lines += ["", f"{_many(failed)}, the first because:", *textwrap.wrap(failed[0], 100)]
    return "\n".join(line.rstrip() for line in lines)


def _line(row: list[str], widths: list[int]) -> str:
    first, *others = zip(row, widths, strict=True)
    return "  ".join([first[0].ljust(first[1]), *(cell.rjust(width) for cell, width in others)])


def page(result: Result) -> str:
    """The result as one HTML element for a notebook."""
    verdict = result.verdict
    badge = (
        f'<span style="background:{COLOURS[verdict]};color:#111;padding:2px 10px;border-radius:3px;font-weight:600">'
        f"{ICONS[verdict]} {verdict.capitalize()}</span>"
    )
    failing = [f"<li><b>{escape(c.title)}</b>: {escape(c.text)}</li>" for c in verdict.checks if c.standing != "holds"]
    listed = f'<ul style="margin:6px 0">{"".join(failing)}</ul>' if failing else ""
    sure = "" if verdict.sureness is None else f'<p style="opacity:.8">{escape(verdict.sureness.text)}</p>'
    cites = "".join(f"<p>{escape(line)}</p>" for line in _cites(result))
    failed = ""
    if why := _failed(result):
        failed = f"<p>{_many(why)}, the first because: <code>{escape(why[0])}</code></p>"
    return (
        f'<div style="font-family:system-ui,sans-serif;font-size:13px;max-width:760px;color:inherit">{badge}'
        f'<p style="margin:8px 0">{escape(verdict.sentence)}</p>'
        f"{cites}{listed}{sure}{_table(result)}{failed}{_convergence(result)}</div>"
    )


def _cites(result: Result) -> list[str]:
    """The sentences on the search that it resumed."""
    return [] if result.origin.cites is None else citing(result.origin.cites)


def _failed(result: Result) -> list[str]:
    """The reasons of the evaluations that failed; those that were excluded or tried again have reasons, too."""
    return [why for row, why in sorted(result.reasons.items()) if result.status[row] not in ("excluded", "ok")]


def _many(failed: list[str]) -> str:
    return f"{count(len(failed))} evaluation failed" if len(failed) == 1 else f"{count(len(failed))} evaluations failed"


def _value(result: Result) -> str:
    return f"{result.quantity} [{result.unit}]" if result.unit else result.quantity


def _rows(result: Result) -> list[list[str]]:
    n, threshold = result.nominal, result.threshold
    values = ["failed" if n.cost is None else beside(n.cost, threshold), "" if n.margin is None else signed(n.margin)]
    rows = [["", _value(result), "margin", *result.names, "found by"]]
    interval = result.origin.campaign.interval
    bounds = {p: interval(f"simulator.{p}", n.parameters[p]) for p in result.names}
    rows.append(["nominal", *values, *(between(n.parameters[p], *bounds[p]) for p in result.names), ""])
    known = methods()
    for f in result.findings:
        found = ", ".join(known[m].title if m in known else m for m in f.methods) or "no search"
        parameters = [between(f.parameters[p], *bounds[p]) for p in result.names]
        evaluated = "" if f.evaluated == f.cost else f" (evaluated: {beside(f.evaluated, threshold)})"
        rows.append([f.label, beside(f.cost, threshold) + evaluated, signed(f.margin), *parameters, found])
    return rows


def _table(result: Result) -> str:
    cell = "padding:2px 10px;text-align:right;border-bottom:1px solid rgba(128,128,128,.35)"
    rows = []
    for k, row in enumerate(_rows(result)):
        tag = "td" if k else "th"
        rows.append("".join(f'<{tag} style="{cell}">{escape(c)}</{tag}>' for c in row))
    body = "".join(f"<tr>{row}</tr>" for row in rows)
    return (
        '<div style="overflow-x:auto"><table style="border-collapse:collapse;font-variant-numeric:tabular-nums;'
        f'color:inherit;font-size:inherit;background:none;margin:6px 0">{body}</table></div>'
    )


def _convergence(result: Result) -> str:
    """The best value so far of every search over its evaluations, and the threshold."""
    lines: list[Line] = []
    for name in dict.fromkeys(result.method[result.method != ""].tolist()):
        costs = np.where(np.isnan(c := result.costs[result.method == name]), np.inf, c)
        best = np.minimum.accumulate(costs)
        steps = np.flatnonzero(np.isfinite(best))
        if len(steps):
            changed = steps[np.r_[True, np.diff(best[steps]) < 0]]
            kept = changed[np.unique(np.linspace(0, len(changed) - 1, MOST).round().astype(int))]
            lines.append((name, np.r_[kept + 1, len(best)], best[np.r_[kept, len(best) - 1]]))
    if not lines:
        return ""
    values = np.concatenate([best for _, _, best in lines] + [[result.threshold]])
    low, high = float(values.min()), float(values.max())
    pad = 0.06 * (high - low) or max(abs(high), 1.0) * 0.06
    return _drawn(result, lines, low - pad, high + pad, max(int(x[-1]) for _, x, _ in lines))


def _drawn(result: Result, lines: list[Line], low: float, high: float, most: int) -> str:
    wide, tall = WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM

    def x(at: float) -> str:
        return f"{LEFT + wide * at / most:.1f}"

    def y(value: float) -> str:
        return f"{TOP + tall * (high - value) / (high - low):.1f}"

    parts, legend, known = [], [], methods()
    for k, (name, evaluations, best) in enumerate(lines):
        colour = LINES[k % len(LINES)]
        pairs = list(zip(np.asarray(evaluations).tolist(), np.asarray(best).tolist(), strict=True))
        steps = f"M{x(pairs[0][0])},{y(pairs[0][1])}" + "".join(f"H{x(e)}V{y(v)}" for e, v in pairs[1:])
        parts.append(f'<path d="{steps}" fill="none" stroke="{colour}" stroke-width="1.8"/>')
        title = escape(known[name].title if name in known else name)
        legend.append(f'<span style="white-space:nowrap"><span style="color:{colour}">━</span> {title}</span>')
    at = y(result.threshold)
    parts.append(f'<path d="M{LEFT},{at}H{WIDTH - RIGHT}" stroke="currentColor" stroke-dasharray="5 4" fill="none"/>')
    parts.append(
        f'<path d="M{LEFT},{TOP}V{TOP + tall}H{WIDTH - RIGHT}" stroke="currentColor" opacity=".5" fill="none"/>'
    )
    ticks = (low + 0.06 * (high - low), 0.5 * (low + high), high - 0.06 * (high - low))
    parts += [f'<text x="{LEFT - 6}" y="{y(v)}" text-anchor="end" dy="4">{v:.4g}</text>' for v in ticks]
    below = TOP + tall + 15
    parts += [f'<text x="{x(v)}" y="{below}" text-anchor="middle">{count(v)}</text>' for v in (0, most // 2, most)]
    parts.append(f'<text x="{LEFT + wide / 2}" y="{HEIGHT - 6}" text-anchor="middle">evaluations of each search</text>')
    middle = TOP + tall / 2
    label = escape(f"lowest {_value(result)}")
    parts.append(f'<text transform="translate(13,{middle}) rotate(-90)" text-anchor="middle">{label}</text>')
    legend.append(f'<span style="white-space:nowrap">╌ threshold {escape(limit(result.threshold))}</span>')
    return (
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" role="img" aria-label="{label} over evaluations" '
        f'style="max-width:100%;height:auto;font:11px system-ui,sans-serif;color:inherit" fill="currentColor">'
        f'{"".join(parts)}</svg><div style="display:flex;flex-wrap:wrap;gap:4px 16px">{"".join(legend)}</div>'
    )
