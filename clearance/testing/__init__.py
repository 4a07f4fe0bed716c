"""The contract tests of components, methods and simulators, for the packages that declare them.

    from clearance.testing import MethodContract

    class TestMine(MethodContract):
        method = mine.method

Nothing here needs pytest, which collects such classes as any other tests.
"""

from clearance.testing.components import ComponentContract
from clearance.testing.methods import MethodContract
from clearance.testing.systems import SystemContract

if not __debug__:
    raise ImportError("clearance.testing checks by assert statements, which python -O leaves out: run it without -O")

__all__ = ["ComponentContract", "MethodContract", "SystemContract"]
