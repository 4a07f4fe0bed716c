"""Attributes the evaluations of a portfolio to its members."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from itertools import chain

import numpy as np

from campaigns.results.base import OK
from campaigns.results.search import Apart, Member
from campaigns.stored.records import Columns
from worker.engine.search.base import Method, Parallel, Several


@dataclass
class Members:
    """Records a method's requests by member: an evaluation is counted for the first member that requested its point,
    and each that requested it has found it."""

    announced: list[tuple[str, int]] = field(default_factory=list)
    requested: dict[bytes, dict[str, None]] = field(default_factory=dict)
    """Who requested a point, in their order."""

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
                    self.requested.setdefault(point.tobytes(), {})[name] = None
                batch = yield request
        except StopIteration as end:
            rule: str = end.value
            return rule
        finally:
            search.close()

    def rows(self, columns: Columns, methods: Mapping[str, Method], alone: Collection[str] = ()) -> list[Member]:
        """A row per member, in the order of their first evaluations: how many, the best, and how often it led."""
        if not self.requested:
            return []
        by = self._by(columns)
        names = [next(iter(known)) for known in by]
        ranked = np.where(columns.status == OK, columns.costs[:, 0], np.inf)
        before = np.r_[np.inf, np.minimum.accumulate(ranked)[:-1]]
        rows = []
        for member in dict.fromkeys(names):
            mine = np.array([name == member for name in names])
            best = float(ranked[[member in known for known in by]].min())
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
        return (next(iter(self._by(columns)[int(ranked.argmin())])) or None) if np.isfinite(ranked).any() else None

    def apart(self, columns: Columns, methods: Mapping[str, Method], alone: Collection[str]) -> list[Apart]:
        """The parts that were told nothing of each other: every member of `alone`, and the others together; those that
        have a value, and none if that is one part only. What a part requested it found, whoever requested it before."""
        if not self.requested or not alone:
            return []
        by = self._by(columns)
        ranked = np.where(columns.status == OK, columns.costs[:, 0], np.inf)
        found = []
        for part in (None, *alone):

            def belongs(name: str, part: str | None = part) -> bool:
                return name == part if part else name not in alone

            mine = np.array([any(map(belongs, names)) for names in by])
            if not np.isfinite(ranked[mine]).any():
                continue
            low = int(np.flatnonzero(mine)[np.argmin(ranked[mine])])
            known = methods.get(next(filter(belongs, by[low])))
            if known is None:  # a method of its own that did not say who requested the point
                continue
            found.append(
                Apart(
                    member=known.name,
                    title=known.title,
                    family=known.family_with(known.options()),
                    evaluations=sum(belongs(next(iter(names))) for names in by),
                    best=float(ranked[low]),
                    index=low,
                )
            )
        return found if len(found) > 1 else []

    def _by(self, columns: Columns) -> list[dict[str, None]]:
        """Who requested each evaluation, the first first; one that nobody announced is no one's."""
        return [self.requested.get(point.tobytes(), {"": None}) for point in columns.points]
