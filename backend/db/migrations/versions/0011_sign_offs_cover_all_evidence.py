"""sign-offs cover all evidence of a finding: slices, boundary and closest approach had left the digest with 0010

A sign-off whose digest was that of the results is bound to the digest that covers the rest, too; one whose results had
changed stays as it is.
"""

import sqlalchemy as sa
from alembic import op

from backend.db import signed
from backend.db.digest import results_digest
from backend.db.tables import Signoff

revision = "0011"
down_revision = "0010"


def upgrade() -> None:
    connection = op.get_bind()
    runs = sa.select(Signoff.run_id).distinct()
    for run_id in connection.scalars(runs).all():
        before = results_digest(connection, run_id, evidence=False)
        signed.bind_again(connection, run_id, before, results_digest(connection, run_id), "migration 0011")
