"""Parts of a record by the names and types of their forms: `made` here, `read` as stored, `written` to be compared."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, ParamSpec, TypeVar

from pydantic import BaseModel

from campaigns.results.base import Values
from campaigns.results.finding import FoundBy, Validation
from campaigns.results.likelihood import Likelihood
from campaigns.results.slices import Slices

Fields = ParamSpec("Fields")
Form = TypeVar("Form", bound=BaseModel)
OMIT: Any = object()
"""In place of a field that is not compared."""
REST: Any = {}
"""In place of all other fields of a form."""


class Counts(NamedTuple):
    """Numbers of evaluations by status."""

    evaluations: int
    failed: int
    excluded: int


class Finding(NamedTuple):
    """A finding by the stored evaluation at its point."""

    label: str
    cost: float
    margin: float
    at_bounds: dict[str, str]
    validation: Validation
    granted: float = OMIT
    parameters: Values = OMIT
    found: list[FoundBy] = OMIT
    methods: list[str] = OMIT
    slices: Slices = OMIT
    likelihood: Likelihood = OMIT


def made(form: Callable[Fields, Form], *_: Fields.args, **fields: Fields.kwargs) -> Form:
    """A part with these fields, in their order. It is not validated: whatever differs from what is stored must show."""
    known = {name: value for name, value in fields.items() if value is not OMIT}
    part: Form = getattr(form, "model_construct")(set(known), **known)  # noqa: B009
    for name in known:
        vars(part)[name] = vars(part).pop(name)
    return part


def changed(part: Form, **fields: Any) -> Form:
    """The part with these fields, too."""
    known = {name: value for name, value in vars(part).items() if name in part.model_fields_set}
    return made(type(part), **known | fields)


def read(form: type[Form], stored: Any, **parts: BaseModel) -> Form:
    """What is stored, as it is, with these parts of it; None for what is absent."""
    return form.model_construct(**{**dict.fromkeys(form.model_fields), **stored, **parts})


def written(value: Any) -> Any:
    """As a record has it: of a part only the fields that it was made with."""
    if isinstance(value, BaseModel):
        return {name: written(each) for name, each in vars(value).items() if name in value.model_fields_set}
    if isinstance(value, tuple) and hasattr(value, "_asdict"):
        return {name: written(each) for name, each in value._asdict().items() if each is not OMIT}
    if isinstance(value, dict):
        return {name: written(each) for name, each in value.items()}
    return [*map(written, value)] if isinstance(value, list) else value
