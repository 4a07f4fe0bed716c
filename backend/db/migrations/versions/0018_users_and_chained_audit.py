"""users, invitations, owners and scopes of tokens; the audit trail becomes a hash chain

The user `local` of the login link becomes an administrator, and the owner of all tokens, which keep all their rights.
The chain includes the rows that exist now: it proves nothing about the time before this migration.
"""

import time

import sqlalchemy as sa
from alembic import op

from backend.db.chain import FIRST, digest

revision = "0018"
down_revision = "0017"

_AUDIT = sa.table(
    "audit",
    *(sa.column(name) for name in ("id", "at", "user", "via", "action", "subject", "previous", "hash")),
    sa.column("detail", sa.JSON()),
)
_FIXED = "the audit trail is append-only"


def upgrade() -> None:
    _users()
    op.add_column("tokens", sa.Column("owner", sa.String(64), nullable=False, server_default="local"))
    op.add_column("tokens", sa.Column("scope", sa.String(8), nullable=False, server_default="admin"))
    op.add_column("tokens", sa.Column("expires", sa.Double(), nullable=True))
    op.add_column("sessions", sa.Column("via", sa.String(12), nullable=False, server_default="link"))
    op.add_column("sessions", sa.Column("agent", sa.String(200), nullable=False, server_default=""))
    op.add_column("sessions", sa.Column("address", sa.String(64), nullable=False, server_default=""))
    _chain()


def _users() -> None:
    users = op.create_table(
        "users",
        sa.Column("name", sa.String(64), primary_key=True),
        sa.Column("role", sa.String(12), nullable=False),
        sa.Column("password", sa.String(200), nullable=True),
        sa.Column("created", sa.Double(), nullable=False),
        sa.Column("created_by", sa.String(64), nullable=False),
        sa.Column("joined", sa.Double(), nullable=True),
        sa.Column("disabled", sa.Double(), nullable=True),
    )
    op.bulk_insert(users, [{"name": "local", "role": "admin", "created": time.time(), "created_by": "local"}])
    op.create_table(
        "invitations",
        sa.Column("hash", sa.String(64), primary_key=True),
        sa.Column("user", sa.String(64), nullable=False),
        sa.Column("created", sa.Double(), nullable=False),
        sa.Column("created_by", sa.String(64), nullable=False),
        sa.Column("expires", sa.Double(), nullable=False),
        sa.Column("used", sa.Double(), nullable=True),
    )
    op.create_index("ix_invitations_user", "invitations", ["user"])
    op.create_table(
        "service_settings",
        sa.Column("key", sa.String(40), primary_key=True),
        sa.Column("value", sa.JSON(), nullable=False),
    )


def _chain() -> None:
    op.add_column("audit", sa.Column("previous", sa.String(64), nullable=True))
    op.add_column("audit", sa.Column("hash", sa.String(64), nullable=True))
    connection, last, before = op.get_bind(), 0, FIRST
    for row in connection.execute(sa.select(_AUDIT).order_by(_AUDIT.c.id)).mappings().all():
        values = {**row, "previous": before}
        values["hash"] = digest(values)
        linked = {"previous": before, "hash": values["hash"]}
        connection.execute(sa.update(_AUDIT).where(_AUDIT.c.id == row["id"]).values(**linked))
        last, before = row["id"], values["hash"]
    with op.batch_alter_table("audit") as audit:
        audit.alter_column("previous", existing_type=sa.String(64), nullable=False)
        audit.alter_column("hash", existing_type=sa.String(64), nullable=False)
        audit.create_index("ix_audit_action", ["action"])
    head = op.create_table(
        "audit_head",
        sa.Column("id", sa.Integer(), autoincrement=False, primary_key=True),
        sa.Column("row", sa.Integer(), nullable=False),
        sa.Column("hash", sa.String(64), nullable=False),
    )
    op.bulk_insert(head, [{"id": 1, "row": last, "hash": before}])
    _fix()


def _fix() -> None:
    """Refuse changes of rows by mistake; who owns the database can remove this, which the chain is for."""
    if op.get_bind().dialect.name == "sqlite":
        for change in ("UPDATE", "DELETE"):
            op.execute(
                f"CREATE TRIGGER audit_no_{change.lower()} BEFORE {change} ON audit "
                f"BEGIN SELECT RAISE(ABORT, '{_FIXED}'); END"
            )
        return
    op.execute(
        f"CREATE FUNCTION audit_fixed() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN RAISE EXCEPTION '{_FIXED}'; END $$"
    )
    op.execute(
        "CREATE TRIGGER audit_fixed BEFORE UPDATE OR DELETE ON audit FOR EACH ROW EXECUTE FUNCTION audit_fixed()"
    )
