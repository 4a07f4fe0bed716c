"""A campaign as readable YAML, without defaults."""

from __future__ import annotations

from typing import Any

import yaml
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from campaigns.asked.reading import MOST_VALUES, Dumper
from campaigns.asked.spec import Campaign

_ALWAYS = frozenset({"version", "component", "kind", "seed", "certify"})
"""Written even at their default: the first three identify a mapping, the seed determines every result, and without
`certify` a sample is drawn."""


def to_yaml(campaign: Campaign) -> str:
    """YAML text that reads back as an equal campaign (the same digest)."""
    text: str = yaml.dump(_statement(campaign), Dumper=Dumper, sort_keys=False, allow_unicode=True, width=100)
    return text


def readable_yaml(campaign: Campaign) -> str | None:
    """The document as YAML; None if it has more values than are read back, as with very many starts."""
    return None if _values(_statement(campaign)) > MOST_VALUES else to_yaml(campaign)


def _values(statement: Any) -> int:
    """The number of values and keys, as `campaigns.asked.reading` counts them."""
    if isinstance(statement, dict):
        return 1 + len(statement) + sum(map(_values, statement.values()))
    return 1 + sum(map(_values, statement)) if isinstance(statement, list) else 1


def _statement(value: Any) -> Any:
    if isinstance(value, BaseModel):
        fields = type(value).model_fields
        pairs = ((field.alias or name, field, getattr(value, name)) for name, field in fields.items())
        return {key: _statement(inner) for key, field, inner in pairs if _is_written(key, field, inner)}
    if isinstance(value, dict):
        return {key: _statement(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_statement(inner) for inner in value]
    return value


def _is_written(key: str, field: FieldInfo, value: Any) -> bool:
    """Whether the text has this field; what the canonical form omits is omitted here as well."""
    if field.exclude_if is not None and field.exclude_if(value):
        return False
    return key in _ALWAYS or value != field.default
