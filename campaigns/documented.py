"""The base of all pydantic models: the text below a field is its description in JSON schemas.

As pydantic's `use_attribute_docstrings`, but read when a schema is made, which most processes never do: reading the
source of 240 classes took a quarter of the time to import them.
"""

from __future__ import annotations

import ast
import inspect
import operator
import sys
from functools import cache
from itertools import pairwise
from typing import Any

from pydantic import BaseModel, Field, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema


class Documented(BaseModel):
    """A model whose fields are described by the text below them, where `Field` gives no description."""

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        schema = handler(core_schema)
        described = handler.resolve_ref_schema(schema)
        _describe(cls, described.get("properties", {}))
        if handler.mode == "serialization" and "properties" in described:
            described["required"] = [name for name in described["properties"] if not _left_out(cls, name)]
        return schema


def no_default(schema: JsonSchemaValue) -> None:
    """The `json_schema_extra` of a field that is omitted when it has its default: the schema omits it as well."""
    schema.pop("default", None)


def _is_none(value: object) -> bool:
    return value is None


UNLESS_NONE, UNLESS_EMPTY = Field(exclude_if=_is_none), Field(exclude_if=operator.not_)
"""Of a field that is omitted if it is None, or if it is empty."""
UNLESS_STATED = Field(exclude_if=_is_none, json_schema_extra=no_default)
"""Of a number that is omitted if it is None, so that 0 can be stated."""
UNSTATED = Field(exclude_if=operator.not_, json_schema_extra=no_default)
"""Of a field that is omitted if it is empty, also as a default, so that documents without it keep their digests."""


def _left_out(model: type[BaseModel], name: str) -> bool:
    """Whether a field is omitted for some values; all others are in every document, defaults included."""
    field = model.model_fields.get(name)
    return field is not None and field.exclude_if is not None


def _describe(model: type[BaseModel], properties: dict[str, Any]) -> None:
    for name, field in model.model_fields.items():
        text = None if field.description else _text(model, name)
        for known in (name, field.alias, field.serialization_alias):
            if text is not None and known in properties:
                properties[known].setdefault("description", text)


def _text(model: type[BaseModel], field: str) -> str | None:
    """The text below a field, in the class that declares it last."""
    declared = next(c for c in model.__mro__ if field in inspect.get_annotations(c))
    return _texts(declared.__module__).get(declared.__qualname__, {}).get(field)


@cache
def _texts(module: str) -> dict[str, dict[str, str]]:
    """The text below each field of each class of a module, by the class's qualified name."""
    found: dict[str, dict[str, str]] = {}
    _collect(ast.parse(inspect.getsource(sys.modules[module])), "", found)
    return found


def _collect(node: ast.AST, prefix: str, found: dict[str, dict[str, str]]) -> None:
    for inner in ast.iter_child_nodes(node):
        if isinstance(inner, ast.ClassDef):
            found[prefix + inner.name] = dict(_fields(inner.body))
            _collect(inner, f"{prefix}{inner.name}.", found)
        elif isinstance(inner, ast.FunctionDef | ast.AsyncFunctionDef):
            _collect(inner, f"{prefix}{inner.name}.<locals>.", found)
        else:
            _collect(inner, prefix, found)


def _fields(body: list[ast.stmt]) -> list[tuple[str, str]]:
    return [
        (field.target.id, inspect.cleandoc(below.value.value))
        for field, below in pairwise(body)
        if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name)
        if isinstance(below, ast.Expr) and isinstance(below.value, ast.Constant) and isinstance(below.value.value, str)
    ]
