"""The declarative base of all tables, with the column types of their Python types."""

from enum import Enum
from typing import Any

import sqlalchemy as sa
from sqlalchemy import orm

from campaigns.documents import JsonObject

_STATE = sa.Enum(Enum, native_enum=False, length=12, values_callable=list)
"""A StrEnum as text; a value that is no member is refused when it is written, compared or read."""


class Base(orm.DeclarativeBase):
    type_annotation_map = {  # noqa: RUF012
        JsonObject: sa.JSON,
        dict[str, str]: sa.JSON,
        dict[str, float]: sa.JSON,
        list[Any]: sa.JSON,
        float: sa.Double,
        Enum: _STATE,
    }
