"""Changes of what is stored, for the time of a block."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import sqlalchemy as sa


@contextmanager
def changed(engine: sa.Engine, change: sa.Update) -> Iterator[None]:
    """The change of a table, which is undone at the end."""
    table = change.table
    assert isinstance(table, sa.Table)
    with engine.begin() as connection:
        before = connection.execute(table.select()).mappings().all()
        assert connection.execute(change).rowcount > 0
    try:
        yield
    finally:
        with engine.begin() as connection:
            for row in before:
                same = sa.and_(*(column == row[column] for column in table.primary_key))
                connection.execute(table.update().where(same).values(dict(row)))
