"""The texts of requirements: as they are now, and as the campaigns of runs state them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field

import sqlalchemy as sa

from backend.db.engine import chunks
from backend.db.tables import Requirement, Run, RunRequirement
from backend.signoffs.present import counted

OTHER_TEXT = "its campaign states another text of the requirement"
CHANGED_TEXT = "the text of the requirement has changed since the sign-off"
LATER_TEXT = "the text of the requirement was registered or changed after the sign-off"


@dataclass(frozen=True)
class Texts:
    """now: the registered text by id, else that of the newest run that gives one; changed: when it was registered or
    changed; stated: by run and id, empty where the campaign gives the id alone."""

    now: Mapping[str, str]
    changed: Mapping[str, float]
    stated: Mapping[int, Mapping[str, str]] = field(default_factory=dict)

    def of_run(self, run_id: int) -> dict[str, str]:
        """The texts now of the requirements that a run states."""
        return {key: self.now.get(key, "") for key in self.stated.get(run_id, ())}

    def changes(
        self, run_id: int, key: str, signed: Mapping[str, str] | None = None, at: float | None = None
    ) -> Iterator[str]:
        """A run is evidence for the text in its campaign, and a sign-off is of the text when it was given.

        signed: the texts that were stored then, if they were; at: the time of the sign-off.
        """
        stated, now = self.stated.get(run_id, {}).get(key), self.now.get(key, "")
        if stated is None:
            return  # such a sign-off is of the run's results, and of no text
        if stated and _plain(stated) != _plain(now):
            yield OTHER_TEXT
        elif signed is not None and key in signed:
            if _plain(signed[key]) != _plain(now):
                yield CHANGED_TEXT
        elif not stated and at is not None and self.changed.get(key, -1.0) >= at:
            yield LATER_TEXT


def texts(reader: sa.Connection, run_ids: Collection[int], ids: Collection[str] = ()) -> Texts:
    """The texts of these requirements, and of those that these runs state."""
    stated: dict[int, dict[str, str]] = defaultdict(dict)
    for some in chunks(run_ids):
        of = sa.select(RunRequirement.run_id, RunRequirement.requirement, RunRequirement.text)
        for run_id, key, text in reader.execute(of.where(RunRequirement.run_id.in_(some))):
            stated[run_id][key] = text
    now: dict[str, str] = {}
    changed: dict[str, float] = {}
    for names in chunks({*ids, *(key for known in stated.values() for key in known)}):
        newest = sa.select(RunRequirement.requirement, RunRequirement.text).join(Run, Run.id == RunRequirement.run_id)
        newest = newest.where(*counted(), RunRequirement.requirement.in_(names), RunRequirement.text != "")
        now |= {row.requirement: row.text for row in reader.execute(newest.order_by(RunRequirement.run_id))}
        registered = sa.select(Requirement.id, Requirement.text, Requirement.changed).where(Requirement.id.in_(names))
        for row in reader.execute(registered):
            now[row.id], changed[row.id] = row.text, row.changed
    return Texts(now, changed, stated)


def _plain(text: str) -> str:
    return " ".join(text.split())
