"""The Alembic environment: runs on the caller's connection, under the caller's lock.

SQLite cannot alter most of a table; batch mode rebuilds it instead (Alembic, "Running Batch Migrations for SQLite").
"""

from alembic import context

from backend.db.tables import Base

connection = context.config.attributes["connection"]
context.configure(
    connection=connection,
    target_metadata=Base.metadata,
    render_as_batch=connection.dialect.name == "sqlite",
    compare_type=True,
)
context.run_migrations()
