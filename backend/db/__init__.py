"""The database: tables, the queue over the runs table, migrations. Start reading at `backend.db.tables`."""
