"""The tables' history (Alembic). `migrate` in `backend.db.engine` is the only caller."""
