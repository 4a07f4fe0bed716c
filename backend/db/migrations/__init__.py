"""The schema migrations (Alembic). `migrate` in `backend.db.engine` is the only caller."""
