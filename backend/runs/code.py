"""The difference between the code of two runs, by source file."""

from __future__ import annotations

from collections.abc import Collection
from typing import Literal

import sqlalchemy as sa

from backend.db import codes
from backend.db.tables import Run
from backend.runs import identity, service
from backend.runs.schemas import ChangedFile, CodeChanges
from campaigns import Campaign
from campaigns.asked.requirements import definition
from campaigns.checked.check import parts
from campaigns.identity.identity import UNSTORED, Change, Identity, may_equal
from campaigns.versions import differing


def changes(reader: sa.Connection, run_id: int, against: int) -> CodeChanges:
    """What differs between the code of a run and that of another one; 404 if there is no such run.

    Own files and those of the campaign's components and methods come first. What only one of two campaigns uses is no
    difference.
    """
    one, other = (service.campaign(reader, run) for run in (run_id, against))
    used, same = _used(one) | _used(other), one.digest == other.digest
    now, then = (identity.of_run(reader, run) or UNSTORED for run in (run_id, against))
    same_files = same or definition(one.document()) == definition(other.document())
    found = identity.apart(reader, then, now, same, same_files)
    own = [_own(one) for one in found if "/" in one.name]
    return CodeChanges(
        code=now.digest,
        against=then.digest,
        changes=[one.text for one in found],
        unidentified=list(dict.fromkeys(then.unidentified + now.unidentified)),
        same_model=may_equal(then, now),
        same_question=_same_question(reader, run_id, against),
        files=None if (files := _modules(reader, then, now, used, same)) is None else own + files,
    )


def _same_question(reader: sa.Connection, run_id: int, against: int) -> bool | None:
    questions = reader.scalars(sa.select(Run.question).where(Run.id.in_((run_id, against)))).all()
    return None if None in questions else len(set(questions)) == 1


def _own(change: Change) -> ChangedFile:
    how: Literal["changed", "added", "removed"] = "added" if not change.before else "changed"
    return ChangedFile(file=change.name, change=how if change.after else "removed", component=None)


def _modules(
    reader: sa.Connection, then: Identity, now: Identity, used: Collection[str], same: bool
) -> list[ChangedFile] | None:
    """The modules of the engine that differ; None unless those of both are stored. same: whether both campaigns are
    equal, so that what only one has is a difference."""
    if then.engine is not None and then.engine == now.engine:
        return []
    before, after = codes.modules(reader, then.engine), codes.modules(reader, now.engine)
    every = {**before, **after}
    files = [
        ChangedFile(
            file=_file(name, every),
            change="added" if name not in before else "removed" if name not in after else "changed",
            component=stem if (stem := name.rpartition(".")[2]) in used else None,
        )
        for name in differing(before, after)
        if same or (name in before and name in after)
    ]
    return sorted(files, key=lambda file: file.component is None) if before and after else None


def _used(campaign: Campaign) -> set[str]:
    return {part.component for *_, part in parts(campaign)} | {search.method for search in campaign.stages.search}


def _file(module: str, modules: Collection[str]) -> str:
    """The source file of a module; of a package, its own."""
    package = any(other.startswith(f"{module}.") for other in modules)
    return module.replace(".", "/") + ("/__init__.py" if package else ".py")
