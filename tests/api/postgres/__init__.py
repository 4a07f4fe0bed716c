"""The tests of what is stored, once more on PostgreSQL. Start reading at `conftest`."""
