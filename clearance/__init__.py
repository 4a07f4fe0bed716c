"""Clearance from Python: search for the worst case of a function and state what may be claimed.

    import clearance

    result = clearance.search(fly, {"mass": (1.5, 2.3), "drag": (0.1, 0.2)}, threshold=50.0, unit="m")
    print(result)

`search` runs a whole campaign in this process; `simulator` declares a function that campaigns can name. Everything
heavy is loaded by the first search. The guide is docs/python.md. `Client` and `AsyncClient` use a service instead;
their guide is docs/client.md.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from clearance.client import AsyncClient, Client
    from clearance.function.result import Evaluations, Finding, Interrupted, Nominal, Result, Verdict
    from clearance.function.search import search
    from worker.engine.systems.simulators.declared.columns import Column
    from worker.engine.systems.simulators.declared.excluded import Excluded
    from worker.engine.systems.simulators.declared.function import Output, Parameter, simulator

__all__ = [
    "AsyncClient",
    "Client",
    "Column",
    "Evaluations",
    "Excluded",
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
_HOMES = {
    "AsyncClient": "clearance.client",
    "Client": "clearance.client",
    "Column": "worker.engine.systems.simulators.declared.columns",
    "Excluded": "worker.engine.systems.simulators.declared.excluded",
    "Output": "worker.engine.systems.simulators.declared.function",
    "Parameter": "worker.engine.systems.simulators.declared.function",
    "search": "clearance.function.search",
    "simulator": "worker.engine.systems.simulators.declared.function",
}
"""The module of each name that is not in `clearance.function.result`."""


def __getattr__(name: str) -> Any:
    """Load a name with its module when it is first used."""
    if name not in __all__:
        raise AttributeError(f"module 'clearance' has no attribute {name!r}; it has {', '.join(__all__)}")
    return getattr(importlib.import_module(_HOMES.get(name, "clearance.function.result")), name)


def __dir__() -> list[str]:
    return sorted(__all__)
