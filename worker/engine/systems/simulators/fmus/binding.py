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

from fmpy import calloc as calloc  # noqa: E402
from fmpy import free as free  # noqa: E402
from fmpy.fmi1 import FMICallException as FMICallException  # noqa: E402
from fmpy.fmi2 import FMU2Slave as FMU2Slave  # noqa: E402
from fmpy.fmi2 import fmi2CallbackAllocateMemoryTYPE as fmi2CallbackAllocateMemoryTYPE  # noqa: E402
from fmpy.fmi2 import fmi2CallbackFreeMemoryTYPE as fmi2CallbackFreeMemoryTYPE  # noqa: E402
from fmpy.fmi2 import fmi2CallbackFunctions as fmi2CallbackFunctions  # noqa: E402
from fmpy.fmi2 import fmi2CallbackLoggerTYPE as fmi2CallbackLoggerTYPE  # noqa: E402
from fmpy.fmi2 import fmi2LastSuccessfulTime as fmi2LastSuccessfulTime  # noqa: E402
from fmpy.fmi2 import fmi2Terminated as fmi2Terminated  # noqa: E402
from fmpy.fmi3 import FMU3Slave as FMU3Slave  # noqa: E402
from fmpy.logging import addLoggerProxy as addLoggerProxy  # noqa: E402
