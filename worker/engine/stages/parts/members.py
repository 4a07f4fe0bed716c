"""Attributes the evaluations of a portfolio to its members."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from campaigns.results.base import OK
from campaigns.results.search import Apart, Member
from campaigns.stored.records import Columns
from worker.engine.search.base import Method, Parallel, Several


@dataclass
class Members:
    """Records a method's requests by member: an evaluation is counted for the first member that requested its point,
    and each that requested it has found it."""

    announced: list[tuple[str, int]] = field(default_factory=list)
    owner: dict[bytes, str] = field(default_factory=dict)
    """The first member that requested a point."""
    others: dict[bytes, set[str]] = field(default_factory=dict)
    """Those that requested it later, of the few points that several did."""

    def attribute(self, member: str, points: int) -> None:
        """The next `count` points of the coming request belong to this member."""
        self.announced.append((member, points))

    def listening(self, search: Parallel) -> Parallel:
        """The search, with its requests recorded."""
        batch = None
        try:
            while True:
                request = next(search) if batch is None else search.send(batch)
                groups = [points for _, points in request.groups] if isinstance(request, Several) else [request]
                announced, self.announced = self.announced, []
                names = [member for member, count in announced for _ in range(count)]
                for name, point in zip(names, chain(*groups), strict=False):
                    if self.owner.setdefault(key := point.tobytes(), name) != name:
                        self.others.setdefault(key, set()).add(name)
                batch = yield request
        except StopIteration as end:
            rule: str = end.value
            return rule
        finally:
            search.close()

    def rows(self, columns: Columns, methods: Mapping[str, Method], alone: Collection[str] = ()) -> list[Member]:
        """A row per member, in the order of their first evaluations: how many, the best, and how often it led."""
        if not self.owner:
            return []
        names = self._names(columns)
        ranked = np.where(columns.status == OK, columns.costs[:, 0], np.inf)
        before = np.r_[np.inf, np.minimum.accumulate(ranked)[:-1]]
        rows = []
        for member in dict.fromkeys(names):
            mine = np.array([name == member for name in names])
            best = float(ranked[mine | self._also(columns, [member])].min())
            known = methods.get(member)
            rows.append(
                Member(
                    member=member,
                    title=known.title if known else member,
                    evaluations=int(mine.sum()),
                    best=best if np.isfinite(best) else None,
                    improvements=int(np.count_nonzero(mine & (ranked < before))),
                    apart=member in alone,
                )
            )
        return rows

    def leading(self, columns: Columns) -> str | None:
        """The member that was the first to request the lowest evaluation; None if nobody announced it or none has a
        value."""
        ranked = np.where(columns.status == OK, columns.costs[:, 0], np.inf)
        low = columns.points[int(ranked.argmin())] if np.isfinite(ranked).any() else None
        return None if low is None else self.owner.get(low.tobytes())

    def apart(self, columns: Columns, methods: Mapping[str, Method], alone: Collection[str]) -> list[Apart]:
        """The parts that were told nothing of each other: every member of `alone`, and the others together; those that
        have a value, and none if that is one part only. What a part requested it found, whoever requested it before."""
        if not self.owner or not alone:
            return []
        names = np.array(self._names(columns))
        ranked = np.where(columns.status == OK, columns.costs[:, 0], np.inf)
        together = sorted({*names.tolist(), *chain(*self.others.values())} - {*alone})
        found = []
        for part in (together, *([name] for name in alone)):
            own = np.isin(names, part)
            mine = own | self._also(columns, part)
            if not np.isfinite(ranked[mine]).any():
                continue
            low = int(np.flatnonzero(mine)[np.argmin(ranked[mine])])
            others = self.others.get(columns.points[low].tobytes(), ())
            known = methods.get(names[low] if own[low] else next(name for name in part if name in others))
            if known is None:  # a method of its own that did not say who requested the point
                continue
            found.append(
                Apart(
                    member=known.name,
                    title=known.title,
                    family=known.family_with(known.options()),
                    evaluations=int(own.sum()),
                    best=float(ranked[low]),
                    index=low,
                )
            )
        return found if len(found) > 1 else []

    def _names(self, columns: Columns) -> list[str]:
        return [self.owner.get(point.tobytes(), "") for point in columns.points]

    def _also(self, columns: Columns, part: Collection[str]) -> NDArray[np.bool_]:
        """Which evaluations one of these members requested after another one."""
        if not self.others:
            return np.zeros(len(columns.points), dtype=bool)
        return np.array([not self.others.get(point.tobytes(), set()).isdisjoint(part) for point in columns.points])
