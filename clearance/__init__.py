"""Clearance from Python: search for the worst case of a function and state what may be claimed.

    import clearance

    result = clearance.search(fly, {"mass": (1.5, 2.3), "drag": (0.1, 0.2)}, threshold=50.0, unit="m")
    print(result)

`search` runs a whole campaign in this process; `simulator` declares a function that campaigns can name. Everything
heavy is loaded by the first search. The guide is docs/python.md.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from worker.catalogue.columns import Column
from worker.catalogue.function import Output, Parameter, simulator

if TYPE_CHECKING:
    from clearance.asked import search
    from clearance.result import Evaluations, Finding, Interrupted, Nominal, Result, Verdict

__all__ = [
    "Column",
    "Evaluations",
    "Finding",
    "Interrupted",
    "Nominal",
    "Output",
    "Parameter",
    "Result",
    "Verdict",
    "search",
    "simulator",
]


def __getattr__(name: str) -> Any:
    """Load the search and its results when they are first used."""
    if name not in __all__:
        raise AttributeError(f"module 'clearance' has no attribute {name!r}; it has {', '.join(__all__)}")
    if name == "search":
        from clearance.asked import search as found

        return found
    from clearance import result

    return getattr(result, name)


def __dir__() -> list[str]:
    return sorted(__all__)
