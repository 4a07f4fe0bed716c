"""without `runs.cancel`, which nothing reads: the state of a run says that it is cancelled, or is to be"""

from alembic import op

revision = "0034"
down_revision = "0033"


def upgrade() -> None:
    # Not in a batch, which would make the table again. Workers of the version before read and write other columns only.
    op.drop_column("runs", "cancel")
