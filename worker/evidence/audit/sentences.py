"""Composes the sentences of a run's stages again, from recomputed numbers, and compares sentences span by span.

The templates are those of the run (`campaigns.claims.stages`): what must agree is that they were used, with these
numbers. The sentences of the verdict itself are made again by `worker.evidence.restatement`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from pydantic import TypeAdapter, ValidationError

from campaigns.claims.numbers import Format, rounded
from campaigns.claims.say import count, say
from campaigns.claims.spans import Quantity, Span, Spans, values, words
from campaigns.claims.stages import ends
from campaigns.claims.stages import sample as templates
from campaigns.results.sample import Sample
from worker.evidence.audit import limits
from worker.evidence.audit.parts import changed
from worker.evidence.audit.recompute import Run
from worker.evidence.audit.record import Missing

SPANS: TypeAdapter[Spans] = TypeAdapter(Spans)


def alike(stated: Any, expected: Spans | Missing) -> bool:
    """Whether stored spans are these; their numbers may differ by rounding."""
    if isinstance(expected, Missing):
        return False
    try:
        found = SPANS.validate_python(stated)
    except ValidationError:
        return False
    return len(found) == len(expected) and all(map(_same, found, expected))


def shown(stated: Any, expected: Spans | Missing) -> tuple[Any, Any]:
    """Stored and expected spans as their words; as data, if the words alone show no difference."""
    if isinstance(expected, Missing):
        return stated, expected
    text = words(expected)
    if alike(stated, expected):
        return text, text
    try:
        found = words(SPANS.validate_python(stated))
    except ValidationError:
        return str(stated), text
    return (found, text) if found != text else (str(stated), str([span.model_dump(mode="json") for span in expected]))


def of_sample(run: Run, k: int, sample: Sample) -> Sample:
    """The sample with its sentences if it gives a bound; those of any other name what its method drew, as taken."""
    certify = run.campaign.stages.certify
    if sample.upper_bound is None or run.reworded:
        return sample
    terms = _terms(run, certify=k not in run.searches)
    # One that is short of samples has the number that was requested, so that another one disagrees.
    size, (failed, excluded, outside) = run.draws(k) - sample.excluded, (sample.failed, sample.excluded, sample.outside)
    numbers = sample.violations, size, failed, excluded, outside, run.campaign.confidence
    criterion = run.claims["components"].component("criterion", run.campaign.criterion.component)
    own_rule = criterion is not None and criterion.own_rule
    counts = templates.Counts(*numbers, terms, run.campaign.simulator is not None, _seed(run, k), own_rule)
    statement = counts.bound(sample.upper_bound)
    if sample.looks:
        level = 1.0 - (1.0 - run.campaign.confidence) / (sample.looks * (sample.looks + 1))
        statement = templates.interim(statement, sample.looks, level)
    allowed, before = run.early(k)
    if before is not None and certify is not None:
        target = run.campaign.target_probability or 1.0
        statement = templates.curtailed(statement, allowed, target, certify.samples, before)
    if (quantile := sample.quantile) is None:
        return changed(sample, statement=statement)
    assert certify is not None
    fields = certify.quantile, run.quantity, run.unit, quantile.order or 0, quantile.needed, quantile.bound
    return changed(sample, quantile=changed(quantile, statement=counts.quantile(*fields)), statement=statement)


def of_certified(run: Run, k: int, sample: Sample) -> Spans | None:
    """The sentence of a certify stage on its sample as a whole, if it gives a bound."""
    certify = run.campaign.stages.certify
    if certify is None or sample.upper_bound is None or run.reworded:
        return None
    size, quantile = run.draws(k) - sample.excluded, sample.quantile
    if quantile is None:
        return sample.statement
    return templates.certified(sample.statement, quantile.statement, size, certify.samples) or sample.statement


def worded(stated: object, statement: Spans, version: int) -> str:
    """The words of spans, as the version of the sentences that stated them wrote them: earlier ones could write a
    fraction below 1 as 100 %."""
    before = words(tuple(map(_as_all, statement)))
    return before if version < limits.GRANTED and stated == before else words(statement)


def _as_all(span: Span) -> Span:
    """A fraction that its digits alone do not tell from 1 as 1."""
    if not isinstance(span, Quantity) or span.format is not Format.PROBABILITY:
        return span
    near = abs(rounded(span.value, span.format, span.digits)) == 1
    return span.model_copy(update={"value": math.copysign(1.0, span.value)}) if near else span


def unlike(document: Any, version: int, path: str = "") -> Iterator[tuple[str, str, str]]:
    """Every text in a result that is not the words of its own spans, and every number that is not theirs: path, the
    text as written and as the spans have it. version: that of the sentences."""
    for key, value in document.items() if isinstance(document, dict) else enumerate(document):
        if isinstance(value, dict | list):
            yield from unlike(value, version, f"{path}.{key}".lstrip("."))
    if not isinstance(document, dict) or not isinstance(document.get("statement"), list | tuple):
        return
    try:
        spans = SPANS.validate_python(document["statement"])
    except ValidationError:
        yield f"{path}.statement", "spans", "none that can be read"
        return
    if isinstance(text := document.get("text"), str) and text != worded(text, spans, version):
        yield f"{path}.text", text, words(spans)
    if isinstance(named := document.get("values"), dict) and "sentence" not in document and named != values(spans):
        yield f"{path}.values", str(named), str(values(spans))


def _same(stated: Span, expected: Span) -> bool:
    if not isinstance(stated, Quantity) or not isinstance(expected, Quantity):
        return stated == expected
    near = math.isclose(stated.value, expected.value, rel_tol=1e-9, abs_tol=1e-15)
    return near and stated == expected.model_copy(update={"value": stated.value})


def _seed(run: Run, k: int) -> str:
    """Which seed a sample has: that of the campaign, of a certify stage one of its own, drawn unless it was stated."""
    if k in run.searches:
        return templates.CAMPAIGN_SEED
    return "" if run.claims["results"][k].get("drawn_at_launch") is True else templates.STATED_SEED


def _terms(run: Run, certify: bool) -> templates.Terms:
    """The noise of a sample's evaluations."""
    if run.random and certify:
        return templates.DRAWN
    simulator = run.campaign.simulator
    if run.calls.noisy and simulator is not None:
        one = certify or run.calls.number == 1
        return templates.CALLED if one else templates.combined(simulator.combine, simulator.calls)
    if run.random:
        stated = run.campaign.given_scenario.realisations
        return templates.stated(stated.combine, stated.seeds)
    return templates.WITHOUT


def budget(evaluations: int) -> Spans:
    """That a stage used its budget."""
    before, _, after = ends.BUDGET.partition("{budget}")
    return say(before, count(evaluations, "budget"), after)
