"""Migrates a database to the newest schema with Alembic."""

from __future__ import annotations

from pathlib import Path

import sqlalchemy as sa
from alembic import command
from alembic.config import Config

FOLDER = Path(__file__).parent / "migrations"


def to_head(connection: sa.Connection) -> None:
    """Run all pending migrations on the caller's connection, in its transaction."""
    command.upgrade(config(connection), "head")


def config(connection: sa.Connection) -> Config:
    found = Config(attributes={"connection": connection})
    found.set_main_option("script_location", str(FOLDER).replace("%", "%%"))
    found.set_main_option("path_separator", "os")
    return found
