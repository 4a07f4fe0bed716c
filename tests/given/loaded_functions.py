"""Functions of modules that are written down as text."""

from __future__ import annotations

import types
from typing import Any


def loaded(text: str, **names: Any) -> Any:
    """The function `f` of a module's text, in which these names have these values."""
    module = types.ModuleType("some_component")
    vars(module).update(names)
    exec(compile(text, "some_component.py", "exec"), vars(module))
    return vars(module)["f"]
