"""The search stages of a call of `clearance.search`, and the campaign that its arguments describe."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

PER_PARAMETER = 1000
"""Evaluations of the search that is proposed, for each parameter; half of it for each of those that are chosen."""

Document = Mapping[str, object]
"""A part of a campaign file."""


def searches(
    methods: object, budget: int | None, options: object, starts: object, ranges: Mapping[str, object]
) -> list[Document]:
    """The stages; raises TypeError or ValueError for arguments that do not fit together."""
    from campaigns.asked.proposal import ranked
    from worker.running.catalogue.installed import catalogue

    plain = [method.name for method in ranked(catalogue().methods)]
    usual = PER_PARAMETER * len(ranges) // (1 if methods is None else 2)
    spent = _spent(methods, plain, usual if budget is None else budget)
    stated = _options(options, spent)
    points = _starts(starts, ranges)
    takes = {method.name for method in catalogue().methods if method.starts} if points else set()
    if points and not takes & spent.keys():
        raise ValueError(f"starts: no method that is used takes start points; these do: {', '.join(sorted(takes))}")
    return [
        {"method": name, "evaluations": value, "options": stated.get(name, {})}
        | ({"starts": points} if name in takes else {})
        for name, value in spent.items()
    ]


def _spent(methods: object, plain: list[str], usual: int) -> dict[str, int]:
    if methods is None:
        methods = plain[:1]
    if isinstance(methods, str):
        methods = [methods]
    if not isinstance(methods, (Mapping, Sequence)) or not methods:
        raise TypeError(f"methods must be names such as {plain[1:3]}, given {methods!r:.60}")
    spent = dict(methods) if isinstance(methods, Mapping) else dict.fromkeys(methods, usual)
    if len(spent) < len(methods):
        raise ValueError("methods: the same method is given twice; list each once")
    for name, value in spent.items():
        if isinstance(value, bool) or not isinstance(value, int) or value < 1:
            raise ValueError(f"methods: the evaluations of {name} must be a whole number above 0, given {value!r:.60}")
    return spent


def _options(options: object, spent: Mapping[str, int]) -> Mapping[str, Mapping[str, object]]:
    if options is None:
        return {}
    if not isinstance(options, Mapping) or not all(isinstance(of, Mapping) for of in options.values()):
        raise TypeError(f"options must be a dict such as {{'direct': {{'iterations': 100}}}}, given {options!r:.60}")
    for name in options:
        if name not in spent:
            raise ValueError(f"options: {name!r:.60} is not a method of this search; there is {', '.join(spent)}")
    return options


def _starts(starts: object, ranges: Mapping[str, object]) -> list[dict[str, float]]:
    """The starting points by path, as in a campaign; whether a value is in its range is checked with the campaign."""
    if starts is None:
        return []
    if not isinstance(starts, Sequence) or not all(isinstance(point, Mapping) for point in starts):
        raise TypeError(f"starts must be a list such as [{{'mass': 2.0}}], given {starts!r:.60}")
    for name in (name for point in starts for name in point):
        if name not in ranges:
            raise ValueError(f"starts: there is no parameter {name!r:.60}; there is {', '.join(ranges)}")
    return [{f"simulator.{name}": value for name, value in point.items()} for point in starts]


def stages(found: list[Document], certify: int, validation: int | None) -> Document:
    """The stages as `clearance run` reads them."""
    made = {"search": found, "certify": {"samples": certify} if certify else None}
    return made if validation is None else {**made, "validate": {"evaluations": validation}}
