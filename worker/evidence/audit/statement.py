"""What the sentence of the verdict must state: its opening, its methods and its numbers, beside what it states."""

from __future__ import annotations

from typing import Any

from campaigns.claims import earlier
from campaigns.claims.numbers import Format, count
from campaigns.claims.say import listed
from campaigns.claims.spans import Quantity, values, words
from campaigns.results.verdict import SCOPE
from worker.evidence.audit.recompute import Run, Tree
from worker.evidence.audit.sentences import SPANS

OPENINGS = {"cleared": "stayed above", "violated": "falls to or below"}
"""Words in the first sentence of these verdicts; any other says that nothing may be claimed."""


def compared_sentence(run: Run) -> tuple[Tree, Tree]:
    """The stated and the required content of the sentence: its opening, methods, numbers by name, and all words.

    Versions that stored only text rounded the numbers to the digits of the text: they are compared as written.
    """
    claims, exact, spent = run.claims, "statement" in run.claims, dict[str, int]()
    statement = SPANS.validate_python(claims["statement"]) if exact else earlier.verdict(claims["reason"])
    text, scope = words(statement), words(SPANS.validate_python(claims["holds_for"] if exact else ()))
    spans = {span.name: span for span in statement if isinstance(span, Quantity)}
    numbers, begun = _numbers(run), text.partition(".")[0]
    for k in run.searches:
        spent[run.methods[k].title] = spent.get(run.methods[k].title, 0) + run.ended[k]["evaluations"]
    methods = f"{words(listed([f'{title} ({count(n)})' for title, n in spent.items()]))}."
    nothing = f"No {'flight' if run.campaign.simulator is None else 'case'} could be evaluated"
    opening = OPENINGS.get(claims["verdict"], "Nothing may be claimed") if len(run.costs) else nothing

    def written(name: str, value: Any) -> Any:
        if exact or value is None or name not in spans:
            return value
        span = spans[name].model_copy(update={"value": value})
        upward = words((span.model_copy(update={"format": Format.AT_MOST}),)) if name == "upper_bound" else ""
        return upward if upward == words((spans[name],)) else words((span,))

    stated: Tree = {"opening": opening if opening in begun else begun, "words": claims["reason"]}
    expected: Tree = {"opening": opening, "words": f"{text} {SCOPE}{scope}" if scope else text}
    if run.sealed:
        stated |= {k: claims.get(k) for k in ("sentence", "scope", "values")}
        expected |= {"sentence": text, "scope": f"{SCOPE}{scope}" if scope else "", "values": values(statement)}
    if len(run.costs):
        stated |= {name: written(name, spans[name].value if name in spans else None) for name in numbers}
        expected |= {name: written(name, value) for name, value in numbers.items()}
        stated["methods"], expected["methods"] = text.partition("searched by ")[2][: len(methods)], methods
    stated["checks"] = {c["name"]: c["text"] for c in claims["checks"]}
    checks = {c["name"]: words(SPANS.validate_python(c["statement"])) for c in claims["checks"] if "statement" in c}
    return stated, expected | {"checks": checks}


def _numbers(run: Run) -> Tree:
    """The numbers that the sentence must state, by name; None for one that it must not state."""
    verdict, sample = run.claims["verdict"], run.claimed
    numbers: Tree = {
        "threshold": None if verdict == "inconclusive" else run.threshold,
        "evaluations": run.made["succeeded" if verdict == "cleared" else "evaluations"],
        "worst": run.stated,
        "margin": run.stated - run.threshold,
        "excluded": run.made["excluded"] or None if verdict == "cleared" else None,
        "violating": run.made["violating"] or None,
    }
    claimed = sample if verdict != "inconclusive" else None
    return numbers | {name: claimed and claimed[name] for name in ("violations", "samples", "upper_bound")}
