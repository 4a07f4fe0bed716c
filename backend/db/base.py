"""The root of all tables, and how their Python types are stored. The tables are in `backend.db.tables`."""

from __future__ import annotations

from typing import Any

import sqlalchemy as sa
from sqlalchemy import orm


class Base(orm.DeclarativeBase):
    type_annotation_map = {dict[str, Any]: sa.JSON, list[Any]: sa.JSON, float: sa.Double}  # noqa: RUF012
