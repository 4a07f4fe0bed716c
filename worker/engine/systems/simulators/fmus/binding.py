"""The calls of FMI from FMPy, without its modules for descriptions, plots and numpy.

A process that evaluates one case spends most of its time importing: 0.27 s with these modules, 0.07 s without. Only the
process of a slot may import this module; others of FMPy do not work there afterwards.
"""

from __future__ import annotations

import sys
from types import ModuleType
from typing import Any


class _Absent(ModuleType):
    """A module whose functions are never called."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return None


_PARTS = ("fmpy.model_description", "fmpy.simulation", "fmpy.util")
if "fmpy" not in sys.modules:
    sys.modules.update({name: _Absent(name) for name in _PARTS})

from fmpy import fmi1 as fmi1  # noqa: E402
from fmpy import fmi2 as fmi2  # noqa: E402
from fmpy import fmi3 as fmi3  # noqa: E402
from fmpy.logging import addLoggerProxy as addLoggerProxy  # noqa: E402
