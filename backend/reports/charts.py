"""Selects the figures of a report from the stored results."""

from __future__ import annotations

from markupsafe import Markup

from backend.reports import figures, plan_view, plot, words
from backend.reports.held import Held
from campaigns.claims import numbers
from campaigns.results import CertifyResult, SearchResult, SensitivityResult
from campaigns.results.sample import Sample
from campaigns.results.sensitivity import Curve

MOST_CURVES = 12


def drawn(held: Held) -> dict[str, object]:
    """Every figure by name; None or empty if there are no stored data for it."""
    timed = [case for case in held.cases if case.points("t", "separation")]
    return {
        "plan": plan_view.plan_view(held.cases, held.of) if held.cases else None,
        "plan_caption": plan_view.caption(held.cases, held.of) if held.cases else "",
        "separation": figures.separation(timed, held.of) if timed else None,
        "convergence": _convergence(held),
        "keys": [(title, colour) for colour, title, _ in _series(held)],
        "sensitivity": _sensitivity(held),
        "through_worst": bool(_slices(held)),
        "tornado": _tornado(held),
        "histogram": _histogram(held),
        **_off(held),
    }


def _off(held: Held) -> dict[str, bool]:
    """The figures whose axis does not include the criterion because it is too far away; their captions state so."""
    limit = held.of.threshold
    if limit is None:
        return {"off": False, "sensitivity_off": False, "sample_off": False}
    found = [y for _, _, points in _series(held) for _, y in points]
    studied = [c for curve in _curves(held) for c in curve.costs if c is not None]
    stated = sample(held)
    edges = (stated.histogram.edges if stated is not None and stated.histogram is not None else []) or [limit]
    spread = edges[-1] - edges[0] or 1.0
    return {
        "off": bool(found) and figures.is_far(found, limit),
        "sensitivity_off": bool(studied) and not _holds(held, studied),
        "sample_off": not edges[0] - 2 * spread <= limit <= edges[-1] + 2 * spread,
    }


def _holds(held: Held, values: list[float]) -> bool:
    """Whether the criterion is near enough to these values to be on their axis."""
    low, high = plot.padded(values, 0.12)
    limit = held.of.threshold
    return limit is not None and low - 6 * (high - low) <= limit


def _series(held: Held) -> list[tuple[str, str, list[plot.Point]]]:
    """The convergence history of every search: colour, title, points."""
    titles = {stage.position: result.title for stage, result in held.results(SearchResult)}
    found = []
    for series in held.evaluations.stages:
        if series.kind == "search":
            steps = zip(series.improvements["index"], series.improvements["cost"], strict=True)
            points = [(index + 1.0, cost) for index, cost in steps]
            found.append((_colour(held, series.method), titles.get(series.position) or series.method or "", points))
    return [row for row in found if row[2]]


def _colour(held: Held, method: str | None) -> str:
    look = held.looks.method(method or "")
    return plot.NOMINAL if look is None else look.colour


def _convergence(held: Held) -> Markup | None:
    series = _series(held)
    return figures.convergence(series, held.of) if series else None


def _curves(held: Held) -> list[Curve]:
    study = held.result(SensitivityResult)
    return [] if study is None else study.curves


def _slices(held: Held) -> dict[str, Curve]:
    """The curves through the worst case by path, if they were evaluated."""
    through = held.findings[0].slices if held.findings else None
    return {} if through is None else {curve.path: curve for curve in through.curves}


def _sensitivity(held: Held) -> list[tuple[Markup, str, Markup]]:
    """A small chart for each parameter: symbol, description, drawing."""
    curves, through = _curves(held), _slices(held)
    values = [c for curve in [*curves, *through.values()] for c in curve.costs if c is not None]
    if not values:
        return []
    near = [held.of.threshold] if held.of.threshold is not None and _holds(held, values) else []
    low, high = plot.padded([*values, *near], 0.1)
    found = []
    for curve in curves[:MOST_CURVES]:
        about = _about(held, curve)
        svg = figures.sensitivity(curve, through.get(curve.path), about, (low, high), held.of)
        found.append((words.symbol_html(about.symbol, curve.path), about.text, svg))
    return found


def _about(held: Held, curve: Curve) -> figures.About:
    path = curve.path
    entry = held.entry(path)
    nominal, low, high = held.limits.get(path, (curve.values[0], curve.values[0], curve.values[-1]))
    return figures.About(
        symbol=held.symbol(path),
        text=held.words(path),
        unit=numbers.unit_in_print(entry.unit) if entry else "",
        nominal=nominal,
        low=low,
        high=high,
        nominal_cost=held.run.nominal_cost if path in held.limits else None,
    )


def _tornado(held: Held) -> Markup | None:
    nominal = held.run.nominal_cost
    bars = []
    for curve in _curves(held):
        low, high = curve.costs[0], curve.costs[-1]
        if nominal is not None and low is not None and high is not None:
            bars.append((_about(held, curve).symbol, low - nominal, high - nominal))
    bars.sort(key=lambda bar: -max(abs(bar[1]), abs(bar[2])))
    return figures.tornado(bars, held.of) if bars else None


def sample(held: Held) -> Sample | None:
    """The independent sample behind the statistical statement: that of certify, else of the first random search."""
    certified = held.result(CertifyResult)
    if certified is not None:
        return certified.sample
    searched = [result.sample for _, result in held.results(SearchResult)]
    return next((s for s in searched if s is not None and s.upper_bound is not None), None)


def _histogram(held: Held) -> Markup | None:
    stated = sample(held)
    if stated is None or stated.histogram is None or not any(stated.histogram.counts):
        return None
    worst = held.findings[0].cost if held.findings else None
    return figures.histogram(stated.histogram.edges, stated.histogram.counts, held.of, held.run.nominal_cost, worst)
