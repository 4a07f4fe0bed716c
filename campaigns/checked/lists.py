"""Which listed part of an earlier campaign (obstacle, disturbance, fault) is which part of another one.

Paths identify a listed part by its index, which is another part's if one is added, removed, or listed elsewhere. Read
`matched`; whatever carries values from one campaign to another by path renames the paths by it.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass

from campaigns.asked.lists import components, prefix_of
from campaigns.asked.regression import Baseline
from campaigns.asked.spec import Campaign
from campaigns.checked.check import LISTED, RANDOM, SEED

SAME = 1e-9
"""Relative difference of two values that one may have from a conversion of units."""


@dataclass(frozen=True)
class Listed:
    """The listed parts of a campaign; None if they are not known."""

    components: Mapping[str, str] | None
    """By the prefix of their paths."""
    fixed: Mapping[str, float]
    """The values of what is not varied, by path."""
    varied: Collection[str]

    @staticmethod
    def of(campaign: Campaign, nominal: Mapping[str, float]) -> Listed:
        """nominal: the values of all parameters by path."""
        fixed = {path: value for path, value in nominal.items() if path not in campaign.uncertain}
        return Listed(components(campaign), fixed, list(campaign.uncertain))

    @staticmethod
    def of_baseline(baseline: Baseline) -> Listed:
        varied = {path for case in baseline.cases for path in case.parameters}
        return Listed(baseline.parts, baseline.fixed or {}, varied)

    def noise(self) -> list[str]:
        """The prefixes of the parts with noise, in the order in which their noise is numbered."""
        random = [name for name, role in LISTED.items() if role in RANDOM]
        seeded = [prefix for prefix in self.components or {} if self._has(f"{prefix}.{SEED}")]
        listed = [(random.index(name), int(i), f"{name}.{i}") for name, i in map(_split, seeded) if name in random]
        return [prefix for _, _, prefix in sorted(listed)]

    def _has(self, path: str) -> bool:
        return path in self.fixed or path in self.varied


@dataclass(frozen=True)
class _Part:
    component: str
    fixed: Mapping[str, float]
    varied: frozenset[str]

    def alike(self, other: _Part) -> bool:
        """Whether both may be one part: the same component, and the same values of what neither campaign varies."""
        return self.apart(other) == 0

    def apart(self, other: _Part) -> float:
        """How many values differ of what neither campaign varies; infinite for another component."""
        common = (self.fixed.keys() & other.fixed.keys()) - (self.varied | other.varied)
        differ = sum(not math.isclose(self.fixed[name], other.fixed[name], rel_tol=SAME) for name in common)
        return differ if self.component == other.component else math.inf


def _split(prefix: str) -> tuple[str, str]:
    name, _, index = prefix.partition(".")
    return name, index


def renamed(path: str, parts: Mapping[str, str]) -> str | None:
    """A path there as it is here, where `parts` are matched; None of a part that is not."""
    prefix = prefix_of(path)
    here = parts.get(prefix) if prefix else prefix
    return None if here is None else here + path.removeprefix(prefix)


def matched(then: Listed, now: Listed) -> dict[str, str]:
    """The prefix here of every part there that is one here.

    That is the part that is alike, wherever it is listed; of several, those of which the same is varied, and of these
    the one at the same index. A part like none was changed, if the same components are listed in the same order, no
    part of the list is at another index, and no other part without a match is closer: fewer of its values differ. Parts
    that are not known match none.
    """
    found: dict[str, str] = {}
    for name in LISTED:
        found |= _matched(_parts(then, name), _parts(now, name))
    return found


def renumbered(then: Listed, now: Listed, parts: Mapping[str, str]) -> list[str]:
    """The prefixes there of parts with noise that is drawn by another number here, so that it is another one."""
    before, here = then.noise(), now.noise()
    both = [prefix for prefix in before if parts.get(prefix) in here]
    return [prefix for prefix in both if here.index(parts[prefix]) != before.index(prefix)]


def reseeded(then: Listed, now: Listed, parts: Mapping[str, str]) -> list[tuple[str, float, float]]:
    """The paths here of the seeds of parts with noise that neither campaign varies and that differ, with the value
    there and here."""
    paths = [(f"{prefix}.{SEED}", f"{parts[prefix]}.{SEED}") for prefix in then.noise() if prefix in parts]
    both = [
        (path, then.fixed[there], now.fixed[path]) for there, path in paths if there in then.fixed and path in now.fixed
    ]
    return [row for row in both if row[1] != row[2]]


def _parts(listed: Listed, name: str) -> dict[str, _Part]:
    prefixes = [prefix for prefix in listed.components or {} if prefix.startswith(f"{name}.")]
    return {prefix: _part(listed, prefix) for prefix in prefixes}


def _part(listed: Listed, prefix: str) -> _Part:
    below = f"{prefix}."
    fixed = {path.removeprefix(below): value for path, value in listed.fixed.items() if path.startswith(below)}
    varied = frozenset(path.removeprefix(below) for path in listed.varied if path.startswith(below))
    return _Part((listed.components or {})[prefix], fixed, varied)


def _matched(there: Mapping[str, _Part], here: Mapping[str, _Part]) -> dict[str, str]:
    alike = {prefix: _alike(part, here) for prefix, part in there.items()}
    found = {prefix: prefix for prefix in there if prefix in alike[prefix]}
    rest = {prefix: [q for q in alike[prefix] if q not in found] for prefix in there if prefix not in found}
    chosen = [each[0] for each in rest.values() if len(each) == 1]
    found |= {prefix: each[0] for prefix, each in rest.items() if len(each) == 1 and chosen.count(each[0]) == 1}
    order, order_here = ({prefix: part.component for prefix, part in each.items()} for each in (there, here))
    unmoved = order == order_here and all(prefix == q for prefix, q in found.items())
    return {prefix: prefix for prefix in there} if unmoved and _nearest(there, here, rest.keys() - found) else found


def _nearest(there: Mapping[str, _Part], here: Mapping[str, _Part], changed: Collection[str]) -> bool:
    """Whether each of the changed parts is as close to the part at its index as to any other changed one."""
    return all(there[p].apart(here[p]) <= min(there[p].apart(here[q]) for q in changed) for p in changed)


def _alike(part: _Part, here: Mapping[str, _Part]) -> list[str]:
    found = [prefix for prefix, other in here.items() if part.alike(other)]
    return [prefix for prefix in found if here[prefix].varied == part.varied] or found
