"""Sentences of versions that stored plain text, as spans: symbols, and numbers with their units, found in the text;
spans of versions that stored them as `said`.

The text does not change: a span is created only where it prints exactly the original text. This is only for data of
earlier versions; new sentences are built by `campaigns.claims.say`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping
from typing import Any, NamedTuple

from campaigns.claims.numbers import MINUS, NARROW, Format
from campaigns.claims.say import Part, say, symbol
from campaigns.claims.spans import Quantity, Spans, words
from campaigns.documents import JsonObject

SENTENCES = {"text": "statement", "sentence": "statement", "scope": "holds_for"}
"""The field with the spans of each kind of sentence."""
SAID = "said"
"""The field of the spans in earlier versions, now `statement`."""
SCOPE = "Scope: "
UPPER_BOUND = "upper_bound"
"""The name of a bound on P(violation), which earlier versions rounded to the nearest."""
_NUMBER = rf"[-+\u2212]?\d(?:[\d{NARROW}]*\d)?(?:\.\d+)?(?:e[-+\u2212]\d+)?"

_COUNT = rf"[\d{NARROW}]+"
_VERDICT = {
    "threshold": ("stayed above |falls to or below ", ""),
    "worst": (r"worst case found has \S+ = ", ""),
    "margin": (r"worst case found .+ a margin of ", ""),
    "evaluations": ("", " evaluations, (?:flights|searched)"),
    "excluded": ("", " more were excluded"),
    "violating": ("", r" stored evaluations? violates? the"),
    "violations": ("", rf" of {_COUNT} flights drawn"),
    "samples": (r"\d of ", " flights drawn"),
    UPPER_BOUND: (r"P\(violation\) is at most ", ""),
}
"""The text before and after each named number of a verdict, as earlier versions wrote it."""


class Terms(NamedTuple):
    """The terms that may occur in the sentences of a run."""

    symbols: Mapping[str, str]
    """The symbol by its written name: d_min for d_min, m for vehicle.m."""
    units: Collection[str]
    """The units that numbers may have."""


def spoken(stored: Any, terms: Callable[[], Terms]) -> Any:
    """A stored result with spans for every sentence that has none, and with upper bounds that are rounded up; `terms`
    is called only if needed."""
    if isinstance(stored, list):
        return [spoken(item, terms) if isinstance(item, dict | list) else item for item in stored]
    if not isinstance(stored, dict):
        return stored
    stored = renamed(stored)
    found = {key: spoken(value, terms) if isinstance(value, dict | list) else value for key, value in stored.items()}
    if stored.get("name") == UPPER_BOUND and stored.get("format") in (Format.PERCENT, Format.PROBABILITY):
        found["format"] = Format.AT_MOST
    for name, field in SENTENCES.items():
        text = stored.get(name)
        if field not in stored and isinstance(text, str):
            found[field] = [span.model_dump() for span in spans(text.removeprefix(SCOPE), terms())]
    return found


def renamed(stored: JsonObject) -> JsonObject:
    """One stored result, without those inside it, with its spans under the name of this version."""
    if not isinstance(stored.get(SAID), list | tuple):
        return stored
    return {"statement" if key == SAID else key: value for key, value in stored.items()}


def throughout(stored: Any) -> Any:
    """A stored document, `renamed` everywhere."""
    if isinstance(stored, list):
        return [throughout(item) for item in stored]
    return {key: throughout(value) for key, value in renamed(stored).items()} if isinstance(stored, dict) else stored


def verdict(reason: str) -> Spans:
    """The sentence of a verdict, with its numbers named as in this version."""
    return spans(reason, Terms({}, ()), _VERDICT)


def spans(text: str, terms: Terms, named: Mapping[str, tuple[str, str]] = {}) -> Spans:
    """The text as spans; `named`: the text before and after each named number."""
    names = sorted((name for name in terms.symbols if terms.symbols[name] != name or "_" in name), key=len)
    any_name = "|".join(map(re.escape, reversed(names))) or "(?!)"
    units = "|".join(map(re.escape, sorted({*terms.units, "%"} - {""}, key=len, reverse=True)))
    pattern = rf"(?<![\w.])(?:(?P<name>{any_name})(?!\w|\.\w))|(?<![\w.\u2212-])(?P<number>{_NUMBER})" + (
        rf"(?: (?P<unit>{units})(?![\w/]))?"
    )
    parts: list[Part] = []
    end = 0
    for match in re.finditer(pattern, text):
        name = _name(text[: match.start()], text[match.end() :], named)
        parts += [text[end : match.start()], _part(match, terms, name)]
        end = match.end()
    return say(*parts, text[end:])


def _name(before: str, after: str, named: Mapping[str, tuple[str, str]]) -> str:
    rules = named.items()
    return next((n for n, (b, a) in rules if re.search(rf"(?:{b})$", before) and re.match(a, after)), "")


def _part(match: re.Match[str], terms: Terms, name: str) -> Part:
    if match["name"]:
        return symbol(match["name"], terms.symbols[match["name"]])
    plain = match["number"].replace(NARROW, "").replace(MINUS, "-")
    value, unit = float(plain), match["unit"] or ""
    own = min(max(len(re.sub(r"e.*|\D", "", plain).lstrip("0")), 1), 17)
    form = Format.PERCENT if unit == "%" else Format.SIGNED if plain[0] == "+" or MINUS in match[0] else Format.PLAIN
    if NARROW in match["number"]:
        form = Format.COUNT
    if form is Format.PERCENT:
        value, unit = value / 100, ""
    # The digits of earlier versions, else as many as shown; else a power of ten as probabilities have it.
    written = [(form, 3 if form is Format.PERCENT else 6), (form, own)]
    for form, digits in [*written, *([] if unit else [(Format.PROBABILITY, 3), (Format.PROBABILITY, own)])]:
        made = Quantity(value=value, unit=unit, format=form, digits=digits, name=name)
        if words((made,)) == match[0]:
            return made
    return match[0]
