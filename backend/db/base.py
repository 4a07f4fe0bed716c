"""The declarative base of all tables, with the column types of their Python types."""

from __future__ import annotations

from typing import Any

import sqlalchemy as sa
from sqlalchemy import orm

from campaigns.documents import JsonObject


class Base(orm.DeclarativeBase):
    type_annotation_map = {JsonObject: sa.JSON, list[Any]: sa.JSON, float: sa.Double}  # noqa: RUF012
