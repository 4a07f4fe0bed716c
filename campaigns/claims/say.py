"""Builds sentences from spans: `say("a margin of ", signed(margin, "m"))`."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from campaigns.claims import numbers
from campaigns.claims.numbers import Format
from campaigns.claims.spans import Quantity, Reference, Span, Spans, Symbol, Target, Text

Part = str | Span | Spans


def say(*parts: Part) -> Spans:
    """One sentence of words, spans and other sentences, in this order."""
    found: list[Span] = []
    for part in parts:
        for span in (Text(text=part),) if isinstance(part, str) else part if isinstance(part, tuple) else (part,):
            last = found[-1] if found else None
            if isinstance(span, Text) and isinstance(last, Text):
                found[-1] = Text(text=last.text + span.text)
            elif not isinstance(span, Text) or span.text:
                found.append(span)
    return tuple(found)


def number(value: float, unit: str = "", name: str = "", digits: int = 6) -> Span:
    """A number with `digits` significant digits."""
    return _quantity(value, unit, Format.PLAIN, digits, name)


def on_side(value: float, threshold: float, unit: str = "", name: str = "", least: int = 6) -> Span:
    """A value with so many digits that it is read on its own side of a threshold."""
    return number(value, unit, name, numbers.digits_beside(value, threshold, least))


def limit(threshold: float, unit: str = "", name: str = "") -> Span:
    """A threshold with all digits that it needs."""
    return number(threshold, unit, name, numbers.digits_of(threshold))


def interval(low: float, high: float, unit: str = "") -> Spans:
    """Bounds with so many digits that what is written is what was searched."""
    digits = numbers.digits_between(low, high)
    return say(number(low, digits=digits), " to ", number(high, unit, digits=digits))


def signed(value: float, unit: str = "", name: str = "") -> Span:
    """A number with its sign."""
    return _quantity(value, unit, Format.SIGNED, 6, name)


def count(value: int, name: str = "") -> Span:
    """A whole number, grouped."""
    return _quantity(value, "", Format.COUNT, 6, name)


def amount(value: int, noun: str, name: str = "") -> Spans:
    """A whole number with its noun, which is in the singular after 1: 1 sample, 2 samples."""
    return say(count(value, name), f" {noun}{'' if value == 1 else 's'}")


def percent(fraction: float, digits: int = 3, name: str = "") -> Span:
    """A fraction as percent."""
    return _quantity(fraction, "", Format.PERCENT, digits, name)


def probability(fraction: float, digits: int = 3, name: str = "") -> Span:
    """A fraction that may be very small."""
    return _quantity(fraction, "", Format.PROBABILITY, digits, name)


def probability_on_side(fraction: float, threshold: float, name: str = "") -> Span:
    """A fraction with so many digits that it is read on its own side of a limit."""
    return probability(fraction, numbers.digits_beside(fraction, threshold, 3, Format.PROBABILITY), name)


def at_most(bound: float, digits: int = 3, name: str = "") -> Span:
    """An upper bound on a probability."""
    return _quantity(bound, "", Format.AT_MOST, digits, name)


def at_least(bound: float, digits: int = 3, name: str = "") -> Span:
    """A lower bound on a probability."""
    return _quantity(bound, "", Format.AT_LEAST, digits, name)


def sure(confidence: float, name: str = "confidence") -> Span:
    """The confidence of a bound or an interval: never read as a higher one."""
    return at_least(confidence, 6, name)


def lowest(bound: float, unit: str = "", name: str = "", digits: int = 6) -> Span:
    """A lower bound that is no probability, or a number that must not read as the one that it is below."""
    return _quantity(bound, unit, Format.LOWEST, digits, name)


def goal(fraction: float, name: str = "target") -> Span:
    """A probability that a bound is compared with: with all its digits, so that no higher bound reads the same."""
    return _quantity(fraction, "", Format.PROBABILITY, 17, name)


def symbol(name: str, label: str = "") -> Span:
    """A criterion's quantity, or a parameter by its path, with its printed symbol."""
    label = label or name
    return Symbol(name=name, symbol=label) if label != name or "_" in name or "." in name else Text(text=name)


def finding(label: str) -> Span:
    """A finding by its label."""
    return Reference(to=Target.FINDING, id=label, label=label)


def case(name: str) -> Part:
    """A case that is simulated again: nominal, a finding by its label, or one of the baseline."""
    return finding(name) if name.startswith("F") and name[1:].isdigit() else name


def method(name: str, title: str) -> Span:
    """A search method by its title."""
    return Reference(to=Target.METHOD, id=name, label=title)


def joined(separator: str, parts: Iterable[Part]) -> Spans:
    """The parts in order, with a separator between them."""
    found = list(parts)
    return say(*[piece for i, part in enumerate(found) for piece in ((separator, part) if i else (part,))])


def listed(parts: Sequence[Part]) -> Spans:
    """A, B and C, without duplicates."""
    statement = list(dict.fromkeys(say(part) for part in parts))
    if len(statement) < 2:
        return statement[0] if statement else say("nothing")
    return say(joined(", ", statement[:-1]), " and ", statement[-1])


def capital(statement: Spans) -> Spans:
    """The sentence with a capital letter, if it begins with text."""
    first = statement[0] if statement else None
    return say(first.text[:1].upper() + first.text[1:], statement[1:]) if isinstance(first, Text) else statement


def unnamed(statement: Spans) -> Spans:
    """The sentence with unnamed numbers: those quoted from another claim are not values of this one."""
    return tuple(s.model_copy(update={"name": ""}) if isinstance(s, Quantity) else s for s in statement)


def sentence(statement: Spans) -> Spans:
    """A clause as a sentence: with a capital letter and a full stop."""
    return say(capital(statement), "") if not statement or ends(statement) else say(capital(statement), ".")


def ends(statement: Spans) -> bool:
    """Whether it ends with a full stop."""
    last = statement[-1] if statement else None
    return isinstance(last, Text) and last.text.endswith(".")


def _quantity(value: float, unit: str, form: Format, digits: int, name: str) -> Span:
    if not math.isfinite(value):
        return Text(text=f"{value} {unit}".rstrip())
    return Quantity(value=value, unit=unit, format=form, digits=digits, name=name)
