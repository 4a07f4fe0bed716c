"""the lowest value of a run without a verdict is that of every stage, not of its searches alone"""

import sqlalchemy as sa
from alembic import op

revision = "0033"
down_revision = "0032"

_KINDS = ("nominal", "sensitivity", "search", "certify", "estimate", "validate")
_RUNS = sa.table(
    "runs",
    sa.column("id", sa.Integer),
    sa.column("verdict", sa.String),
    sa.column("purged", sa.Double),
    sa.column("worst_cost", sa.Double),
    sa.column("worst_method", sa.String),
)
_STAGES = sa.table(
    "stages",
    sa.column("run_id", sa.Integer),
    sa.column("kind", sa.String),
    sa.column("method", sa.String),
    sa.column("best", sa.Double),
)


def upgrade() -> None:
    best, method = (_of_the_lowest(column) for column in (_STAGES.c.best, _STAGES.c.method))
    lower = sa.or_(_RUNS.c.worst_cost.is_(None), _RUNS.c.worst_cost > best)
    open_runs = sa.and_(_RUNS.c.verdict.is_(None), _RUNS.c.purged.is_(None), best.is_not(None), lower)
    op.get_bind().execute(sa.update(_RUNS).where(open_runs).values(worst_cost=best, worst_method=method))


def _of_the_lowest(column: sa.ColumnElement[object]) -> sa.ScalarSelect[object]:
    of = sa.select(column).where(
        _STAGES.c.run_id == _RUNS.c.id, _STAGES.c.kind.in_(_KINDS), _STAGES.c.best.is_not(None)
    )
    return of.order_by(_STAGES.c.best).limit(1).scalar_subquery()
