"""The database: tables, the queue over the runs table, migrations."""
