"""The difference between the code of two runs, by source file."""

from __future__ import annotations

from collections.abc import Collection

import sqlalchemy as sa

from backend.db import codes
from backend.db.tables import Run
from backend.runs import service
from backend.runs.schemas import ChangedFile, CodeChanges
from campaigns import Campaign
from campaigns.checked.check import parts
from campaigns.versions import Versions, differing


def changes(reader: sa.Connection, run_id: int, against: int) -> CodeChanges:
    """The source files in which the code of a run differs from that of another one; 404 if there is no such run.

    Those of the campaign's components and methods come first.
    """
    used = _used(service.campaign(reader, run_id)) | _used(service.campaign(reader, against))
    now, then = _code(reader, run_id), _code(reader, against)
    after, before = codes.modules(reader, now), codes.modules(reader, then)
    if not (after and before):
        return CodeChanges(code=now, against=then, files=[] if now is not None and now == then else None)
    every = {**before, **after}
    files = [
        ChangedFile(
            file=_file(name, every),
            change="added" if name not in before else "removed" if name not in after else "changed",
            component=stem if (stem := name.rpartition(".")[2]) in used else None,
        )
        for name in differing(before, after)
    ]
    return CodeChanges(code=now, against=then, files=sorted(files, key=lambda file: file.component is None))


def _code(reader: sa.Connection, run_id: int) -> str | None:
    return Versions.of(reader.scalar(sa.select(Run.flown).where(Run.id == run_id))).code


def _used(campaign: Campaign) -> set[str]:
    return {part.component for *_, part in parts(campaign)} | {search.method for search in campaign.stages.search}


def _file(module: str, modules: Collection[str]) -> str:
    """The source file of a module; of a package, its own."""
    package = any(other.startswith(f"{module}.") for other in modules)
    return module.replace(".", "/") + ("/__init__.py" if package else ".py")
