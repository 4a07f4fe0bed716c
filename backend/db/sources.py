"""The sources of the components of a run that are not shipped, by which its capsules can be replayed elsewhere."""

from __future__ import annotations

from collections.abc import Mapping

import sqlalchemy as sa

from backend.db.engine import insert
from backend.db.tables import RunSources, SourceText
from campaigns.capsules.sources import Sources


def store(writer: sa.Connection, run_id: int, sources: Sources, texts: Mapping[str, bytes]) -> None:
    """Store the files of a run with their texts by module, unless they are already stored."""
    rows = [{"digest": file.digest, "content": texts[file.module]} for file in sources.files]
    writer.execute(insert(writer, SourceText).on_conflict_do_nothing(), rows)
    row = {"run_id": run_id, "document": sources.model_dump(mode="json")}
    writer.execute(insert(writer, RunSources).values(**row).on_conflict_do_nothing())


def of_run(reader: sa.Connection, run_id: int) -> tuple[Sources, dict[str, bytes]] | None:
    """The files of a run, and their texts by module; None if none are stored."""
    document = reader.scalar(sa.select(RunSources.document).where(RunSources.run_id == run_id))
    if document is None:
        return None
    sources = Sources.model_validate(document)
    digests = {file.digest for file in sources.files}
    of = sa.select(SourceText.digest, SourceText.content).where(SourceText.digest.in_(digests))
    stored = {row.digest: bytes(row.content) for row in reader.execute(of)}
    if stored.keys() != digests:
        return None
    return sources, {file.module: stored[file.digest] for file in sources.files}
