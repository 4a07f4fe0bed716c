"""runs, sweeps and drafts of a token belong to its user; sign-offs have an account

What a token did whose user is not known stays under the token's name.
"""

import sqlalchemy as sa
from alembic import op

revision = "0025"
down_revision = "0024"

_TOKENS = sa.table("tokens", sa.column("name"), sa.column("owner"))
_USERS = sa.table("users", sa.column("name"))


def upgrade() -> None:
    for name in ("runs", "sweeps"):
        op.add_column(name, sa.Column("token", sa.String(64), nullable=True))
        table = sa.table(name, sa.column("owner"), sa.column("token"))
        user = _user(table.c.owner)
        of_token = sa.update(table).where(user.exists())
        op.execute(of_token.values(token=table.c.owner, owner=user.scalar_subquery()))
    drafts = sa.table("drafts", sa.column("owner"))
    user = _user(drafts.c.owner)
    op.execute(sa.update(drafts).where(user.exists()).values(owner=user.scalar_subquery()))
    op.add_column("signoffs", sa.Column("account", sa.String(64), nullable=False, server_default=""))
    op.add_column("signoffs", sa.Column("texts", sa.JSON(), nullable=True))
    signoffs = sa.table("signoffs", sa.column("user"), sa.column("account"))
    found = sa.func.coalesce(_user(signoffs.c.user).scalar_subquery(), signoffs.c.user)
    op.execute(sa.update(signoffs).values(account=found))


def _user(name: sa.ColumnElement[str]) -> sa.Select[str]:
    """The user of the token with this name; nothing if it is a user's."""
    users = sa.select(_USERS.c.name).where(_USERS.c.name == name)
    return sa.select(_TOKENS.c.owner).where(_TOKENS.c.name == name, ~users.exists())
