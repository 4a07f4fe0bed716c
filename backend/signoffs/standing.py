"""The standing of sign-offs, computed here for every page, report and file that shows one. Read `signatures`."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

import sqlalchemy as sa

from backend.db.digest import results_digest
from backend.db.signed import signer
from backend.db.sweeps import in_sweep
from backend.db.tables import CampaignRow, Run
from backend.db.tables import Signoff as Row
from backend.runs import identity
from backend.runs.violations import against, clause, ways
from backend.runs.within import Found
from backend.signoffs.persons import person
from backend.signoffs.present import Present, changes, present
from backend.signoffs.repeats import COLUMNS, CONCLUDED, Repeats
from backend.signoffs.schemas import Signoff, Standing
from backend.signoffs.texts import Texts, texts
from campaigns.runs import run_name

_WITHDRAWN = ("withdrawn", "withdrawn_by", "withdrawn_reason")
_RUN = (*COLUMNS, Run.owner, CampaignRow.name.label("campaign"), CampaignRow.document)


@dataclass(frozen=True)
class Signature:
    """A sign-off of a run's results, on the page of that run or of one that repeats it."""

    row: Any
    on: int
    """The run that shows it."""
    current: bool
    owner: str
    """Who launched the signed run."""
    changed: tuple[str, ...]
    """What has changed since, but for texts of requirements and for other runs."""
    texts: Texts
    repeated_by: int | None = None
    speaking: tuple[Found, ...] = ()
    """The other runs that speak against the run."""

    @property
    def own(self) -> bool:
        """Whether who signed also launched the run: such a sign-off is not independent."""
        return bool(self.row.account == self.owner)

    def reasons(self, requirement: str | None = None) -> Iterator[str]:
        """What makes it suspect as evidence for one requirement, or for all that the run states."""
        if new := self._speaking(known=False):
            yield clause(new)
        yield from self.changed
        for key in sorted(self.texts.stated.get(self.on, ())) if requirement is None else (requirement,):
            for text in self.texts.changes(self.on, key, self.row.texts, self.row.created):
                yield text if requirement is not None else f"{key}: {text}"

    def _speaking(self, known: bool) -> list[Found]:
        """The runs that speak against it as was known when it was signed, or the others."""
        then = self.row.known or {}
        return [o for o in self.speaking if (ways([o]).items() <= then.items()) is known]

    def signoff(self, requirement: str | None = None) -> Signoff:
        row = self.row
        name, typed = signer(row.account, row.name)
        reasons = list(self.reasons(requirement)) if row.withdrawn is None and self.current else []
        standing = self._standing(reasons)
        same = ("id", "role", "comment", "digest", "account", "user", "created", *_WITHDRAWN)
        return Signoff(
            **{name: getattr(row, name) for name in same},
            run=run_name(row.run_id),
            name=name,
            typed=typed,
            stated=None if typed else row.name or None,
            current=self.current,
            standing=standing,
            reasons=reasons,
            repeated_by=None if self.repeated_by is None else run_name(self.repeated_by),
            sentence=self._sentence(standing, reasons),
            own=self.own,
        )

    def _standing(self, reasons: Collection[str]) -> Standing:
        if self.row.withdrawn is not None:
            return "withdrawn"
        if not self.current:
            return "of other results"
        if reasons:
            return "suspect"
        return "standing" if self.repeated_by is None else "carried on"

    def _sentence(self, standing: Standing, reasons: Collection[str]) -> str:
        row = self.row
        if standing == "withdrawn":
            at = datetime.fromtimestamp(row.withdrawn, UTC)
            return f"withdrawn {at:%Y-%m-%d %H:%M} UTC by {row.withdrawn_by}: {row.withdrawn_reason}"
        text = "of earlier results, which have changed since"
        if self.current:
            text = "of these results" if self.on == row.run_id else f"of {run_name(row.run_id)}"
            if self.repeated_by is not None:
                text += f", repeated by {run_name(self.repeated_by)}, bit by bit"
        text += ", by the user who launched the run" if self.own else ""
        if self.current and (known := self._speaking(known=True)):
            text += f", although {clause(known)}, as was known"
        return f"suspect: {'; '.join(reasons)} ({text})" if reasons else text


@dataclass(frozen=True)
class Signed:
    """signatures: of a run, with those that it carries on, oldest first; not_carried: why those of the newest signed
    run of its campaign before it do not count here, if none does."""

    signatures: tuple[Signature, ...] = ()
    not_carried: str | None = None


UNSIGNED = Signed()


def signatures(reader: sa.Connection, run_ids: Collection[int], now: Present | None = None) -> dict[int, Signed]:
    """The sign-offs of these runs, and those of earlier runs that they repeat; at most 500 runs.

    A run that repeats a signed one carries the sign-offs on that are valid, once for each person.
    """
    of = sa.select(*_RUN).join(CampaignRow, CampaignRow.digest == Run.campaign_digest)
    runs = {row.id: row for row in reader.execute(of.where(Run.id.in_(run_ids)))}
    found = _signed(reader, runs)
    if not found:
        return {}
    sources = {row.id: row for row in reader.execute(of.where(Run.id.in_({row.run_id for row in found})))}
    concluded = set(reader.scalars(sa.select(Run.id).where(Run.id.in_({*runs, *sources}), *CONCLUDED)))
    swept = set(reader.scalars(sa.select(Run.id).where(Run.id.in_(runs), in_sweep())))
    digests = {run_id: results_digest(reader, run_id) for run_id in sources}
    current = {row.id: row.digest == digests[row.run_id] for row in found}
    valid = [row for row in found if row.withdrawn is None and current[row.id]]
    repeats, known = Repeats(reader), texts(reader, runs)
    newest = {run_id: repeats.newest(runs[run_id]) for run_id in concluded & runs.keys() & sources.keys()}
    now = present(reader, {row.campaign for row in runs.values()}) if now is None else now
    signed_campaigns = {row.campaign_digest for row in sources.values()}
    speaking = against(reader, [run.id for run in runs.values() if run.campaign_digest in signed_campaigns])
    signed: dict[int, Signed] = {}
    for run_id, run in runs.items():
        own = [row for row in found if row.run_id == run_id]
        earlier = [row for row in valid if row.run_id < run_id and {row.run_id, run_id} <= concluded]
        earlier = [row for row in earlier if sources[row.run_id].campaign_digest == run.campaign_digest]
        differs = {row.run_id: repeats.difference(run, sources[row.run_id]) for row in earlier}
        carried = [row for row in earlier if differs[row.run_id] is None]
        if not own and not carried:
            if differs:
                signed[run_id] = Signed((), _not_carried(differs))
            continue
        # A variant of a sweep is not compared with the campaign that it was made from.
        changed = tuple(
            changes(now, run_id, "" if run_id in swept else run.campaign, run.document, identity.of_row(run))
        )
        items = [
            Signature(
                row, run_id, current[row.id], sources[row.run_id].owner, changed, known,
                newest.get(run_id) if row.run_id == run_id else run_id, tuple(speaking.get(run_id, ())),
            )
            for row in _once(own, carried, current)
        ]  # fmt: skip
        counts = any(one.current and one.row.withdrawn is None for one in items)
        signed[run_id] = Signed(tuple(items), None if counts or not differs else _not_carried(differs))
    return signed


def _not_carried(differs: Mapping[int, str | None]) -> str:
    newest = max(differs)
    return not_carried(run_name(newest), differs[newest])


def not_carried(run: str, difference: str | None) -> str:
    """The clause; run: the signed one."""
    return f"the sign-off of {run} is not carried on to this run: {difference}"


def _signed(reader: sa.Connection, runs: dict[int, Any]) -> list[Any]:
    """The sign-offs of these runs, and the valid ones of other runs of their campaigns, oldest first."""
    of = sa.select(Row.__table__).join(Run, Run.id == Row.run_id)
    campaigns = {row.campaign_digest for row in runs.values()}
    others = sa.and_(Run.campaign_digest.in_(campaigns), Row.withdrawn.is_(None), *CONCLUDED)
    return list(reader.execute(of.where(sa.or_(Row.run_id.in_(runs), others)).order_by(Row.id)).all())


def _once(own: list[Any], carried: list[Any], current: dict[int, bool]) -> list[Any]:
    """All own ones, and of each person who has signed none of these the newest that is carried on."""
    here = {person(row) for row in own if row.withdrawn is None and current[row.id]}
    newest = {person(row): row for row in carried if person(row) not in here}
    return sorted([*own, *newest.values()], key=lambda row: int(row.id))
