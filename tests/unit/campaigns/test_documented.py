"""The text below a field is its description: the same schemas as pydantic's own reading at import."""

from __future__ import annotations

from typing import Annotated, Any

import pytest
from pydantic import BaseModel, ConfigDict, Field

from campaigns.documented import Documented


class Eager(BaseModel):
    """As pydantic reads it."""

    model_config = ConfigDict(use_attribute_docstrings=True)


def models(base: type[BaseModel]) -> list[type[BaseModel]]:
    class First(base):  # type: ignore[misc,valid-type]
        """A model."""

        plain: int
        below: float = 0.0
        """The text below,

        of two paragraphs."""
        stated: Annotated[int, Field(description="As stated.")] = 0
        """Not this one."""
        named: Annotated[str, Field(alias="called")] = ""
        """Under another name."""

    class Second(First):
        below: float = 1.0
        plain: int
        """Described at last."""
        first: First
        """A model in a model."""
        several: list[First] = []  # noqa: RUF012
        """Models."""

        class Inner(base):  # type: ignore[misc,valid-type]
            at: int
            """Within."""

    return [First, Second, Second.Inner]


@pytest.mark.parametrize("k", range(3))
@pytest.mark.parametrize("by_alias", [True, False])
def test_the_schema_is_that_of_pydantic(k: int, by_alias: bool) -> None:
    def schema(base: type[BaseModel]) -> dict[str, Any]:
        return models(base)[k].model_json_schema(by_alias=by_alias)

    made = schema(Documented)
    assert made == schema(Eager)
    assert "description" in str(made)


class Answered(Documented):
    always: int = 0
    sometimes: Annotated[int, Field(exclude_if=lambda given: not given)] = 0


def test_an_answer_has_every_field_but_those_that_it_may_omit() -> None:
    assert Answered.model_json_schema(mode="serialization")["required"] == ["always"]
    assert "required" not in Answered.model_json_schema(mode="validation")
    assert Answered().model_dump() == {"always": 0}
