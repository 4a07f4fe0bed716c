"""How a search ended, as a claim: its sentence with the numbers in it, and the code of its rule."""

from __future__ import annotations

from string import Formatter
from typing import Any, Literal

from campaigns.claims.say import Part, count, number, say
from campaigns.claims.spans import Spans
from campaigns.codes import StopCode
from campaigns.results.base import Stop
from worker.engine.search.base import Ended


def stop(kind: Literal["rule", "budget"], ended: str) -> Stop:
    """The rule by which a search ended; a plain string, from a method of another package, has no code."""
    return Stop(kind=kind, code=ended.code if isinstance(ended, Ended) else StopCode.OTHER, statement=spoken(ended))


def spoken(ended: str) -> Spans:
    """The sentence of a method with its numbers as quantities."""
    if not isinstance(ended, Ended):
        return say(ended)
    parts: list[Part] = []
    for text, name, form, _ in Formatter().parse(ended.template):
        parts.append(text)
        if name is not None:
            parts.append(_part(name, form or "", ended.values[name]))
    return say(*parts)


def _part(name: str, form: str, value: Any) -> Part:
    if isinstance(value, str):
        return spoken(value)
    if form:
        return number(float(value), "", name, int(form[1:-1] or 6) if form.startswith(".") else 6)
    return count(int(value), name)
