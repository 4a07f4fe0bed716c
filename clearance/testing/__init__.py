"""The contract tests of components, methods and simulators, for the packages that declare them.

    from clearance.testing import MethodContract

    class TestMine(MethodContract):
        method = mine.method

Nothing here needs pytest, which collects such classes as any other tests.
"""

from clearance.testing.components import ComponentContract
from clearance.testing.methods import MethodContract
from clearance.testing.systems import SystemContract

__all__ = ["ComponentContract", "MethodContract", "SystemContract"]
