"""What the sentence of the verdict must state: its opening, its methods and its numbers, beside what it states."""

from __future__ import annotations

from typing import Any

from campaigns.claims import earlier
from campaigns.claims.numbers import Format, count
from campaigns.claims.say import listed, say
from campaigns.claims.spans import Quantity, values, words
from campaigns.results.verdict import SCOPE
from worker.evidence.audit.recompute import Run
from worker.evidence.audit.sentences import SPANS, worded

OPENINGS = {"cleared": "stayed above", "violated": "falls to or below"}
"""Words in the first sentence of these verdicts; any other says that nothing may be claimed."""


def compared_sentence(run: Run) -> dict[str, tuple[object, object]]:
    """Pairs of the stated and the required content of the sentence: its opening, methods, numbers, and all words.

    Versions that stored only text rounded the numbers to the digits of the text: they are compared as written.
    """
    claims, exact, spent = run.claims, "statement" in run.claims, dict[str, int]()
    statement = SPANS.validate_python(claims["statement"]) if exact else earlier.verdict(claims["reason"])
    text, scope = (
        worded(claims.get("sentence"), statement, run.written),
        words(SPANS.validate_python(claims["holds_for"] if exact else ())),
    )
    spans = {span.name: span for span in statement if isinstance(span, Quantity)}
    numbers, begun = _numbers(run), text.partition(".")[0]
    for k in run.searches:
        spent[run.methods[k].title] = spent.get(run.methods[k].title, 0) + run.ended[k].evaluations
    methods = f"{words(listed([f'{title} ({count(n)})' for title, n in spent.items()]))}."
    nothing = f"No {'flight' if run.campaign.simulator is None else 'case'} could be evaluated"
    opening = OPENINGS.get(claims["verdict"], "Nothing may be claimed") if len(run.costs) else nothing

    def written(name: str, value: Any) -> Any:
        if exact or value is None or name not in spans:
            return value
        span = spans[name].model_copy(update={"value": value})
        upward = words((span.model_copy(update={"format": Format.AT_MOST}),)) if name == "upper_bound" else ""
        return upward if upward == words((spans[name],)) else words((span,))

    pairs: dict[str, tuple[object, object]] = {"opening": (opening if opening in begun else begun, opening)}
    whole = say(statement, f" {SCOPE}{scope}" if scope else "")
    pairs["words"] = (claims["reason"], worded(claims["reason"], whole, run.written))
    if run.sealed:
        pairs["sentence"] = (claims.get("sentence"), text)
        pairs["scope"] = (claims.get("scope"), f"{SCOPE}{scope}" if scope else "")
        pairs["values"] = (claims.get("values"), values(statement))
    if len(run.costs):
        for name, value in numbers.items():
            pairs[name] = (written(name, spans[name].value if name in spans else None), written(name, value))
        pairs["methods"] = (text.partition("searched by ")[2][: len(methods)], methods)
    checks = {
        c["name"]: worded(c["text"], SPANS.validate_python(c["statement"]), run.written)
        for c in claims["checks"]
        if "statement" in c
    }
    return pairs | {"checks": ({c["name"]: c["text"] for c in claims["checks"]}, checks)}


def _numbers(run: Run) -> dict[str, float | None]:
    """The numbers that the sentence must state, by name; None for one that it must not state."""
    verdict = run.claims["verdict"]
    sample = run.claimed if verdict != "inconclusive" else None
    return {
        "threshold": None if verdict == "inconclusive" else run.threshold,
        "evaluations": run.succeeded if verdict == "cleared" else run.made.evaluations,
        "worst": run.stated,
        "margin": run.stated - run.threshold,
        "excluded": run.made.excluded or None if verdict == "cleared" else None,
        "violating": run.violating or None,
        "violations": sample.violations if sample else None,
        "samples": sample.samples if sample else None,
        "upper_bound": sample.upper_bound if sample else None,
    }
