"""A database that revision 0018 wrote: after the migration its runs state no requirement, and their digests stand.

`stored/revision-0018.sqlite3.gz` was written by the code of that revision: R-0001 is cleared and signed off, R-0002 is
violated.
"""

from __future__ import annotations

import gzip
from pathlib import Path

import sqlalchemy as sa

from backend.db.digest import results_digest
from backend.db.engine import connect, default_url, migrate, read
from backend.db.tables import Campaign as CampaignRow
from backend.db.tables import Requirement, Run, RunRequirement, Signoff
from backend.requirements import matrix
from campaigns.asked.load import load_document

STORED = Path(__file__).parents[1] / "stored" / "revision-0018.sqlite3.gz"


def test_stored_runs_keep_their_digests_and_sign_offs(tmp_path: Path) -> None:
    (tmp_path / "clearance.sqlite3").write_bytes(gzip.decompress(STORED.read_bytes()))
    migrate(default_url(tmp_path))
    engine = connect(default_url(tmp_path))
    with read(engine) as reader:
        for digest, document in reader.execute(sa.select(CampaignRow.digest, CampaignRow.document)).all():
            assert load_document(document, "stored").digest == digest
        assert reader.scalar(sa.select(Signoff.digest)) == results_digest(reader, 1)
        for table in (Requirement, RunRequirement):
            assert reader.scalar(sa.select(sa.func.count()).select_from(table)) == 0
        assert matrix.page(reader, "", None, 10, 1).items == []
        assert reader.scalar(sa.select(sa.func.count()).select_from(Run)) == 2
    engine.dispose()
