"""How a search or a descent ended, without its words."""

from __future__ import annotations

from worker.engine.search.base import Ended


def ending(text: object) -> tuple[str, dict[str, object]]:
    """The code of the rule by which it stopped, and the numbers and rules that its sentence names."""
    assert isinstance(text, Ended), text
    return text.code, text.values
