"""What a process that executes runs tells its supervisor: that it moves, how long it may stand still, and its stage.

In memory that both share, so that the supervisor need not ask a process that is stopped or hangs.
"""

from __future__ import annotations

import math
import mmap
import os
import struct

from worker.engine.systems import optional
from worker.engine.systems.base import Slotted, System
from worker.engine.systems.simulators.called import Called

_LAYOUT = struct.Struct("<Qd")
_STAGE = struct.Struct("<80s")
SIZE = _LAYOUT.size + _STAGE.size


class Pulse:
    """The numbers in a file of memory; without one, of this process alone."""

    def __init__(self, file: int | None = None) -> None:
        self._memory = mmap.mmap(-1 if file is None else file, SIZE)

    @classmethod
    def shared(cls) -> tuple[Pulse, int]:
        """New numbers, and the file that another process opens."""
        file = os.memfd_create("pulse")
        os.ftruncate(file, SIZE)
        return cls(file), file

    @property
    def beats(self) -> int:
        """How often something was stored or compiled."""
        return self._read()[0]

    @property
    def longest(self) -> float:
        """Time that one evaluation may take [s]: infinite where nothing limits it."""
        return self._read()[1]

    @property
    def stage(self) -> str:
        """The stage of the run that is executed, such as "search direct"; empty before the first."""
        (name,) = _STAGE.unpack_from(self._memory, _LAYOUT.size)
        return str(name.rstrip(b"\0").decode(errors="replace"))

    def enter(self, stage: str) -> None:
        """Say which stage is executed from now on."""
        _STAGE.pack_into(self._memory, _LAYOUT.size, stage.encode())

    def beat(self) -> None:
        """Something was stored or compiled."""
        beats, longest = self._read()
        _LAYOUT.pack_into(self._memory, 0, beats + 1, longest)

    def allow(self, longest: float) -> None:
        """Say how long one evaluation may take from now on [s]."""
        _LAYOUT.pack_into(self._memory, 0, self.beats + 1, longest)

    def _read(self) -> tuple[int, float]:
        beats, longest = _LAYOUT.unpack_from(self._memory)
        return beats, longest


own = Pulse()
"""That of this process; `opened` replaces it."""


def opened(file: int) -> None:
    """Use the numbers of this file."""
    global own
    own = Pulse(file)
    os.close(file)


def longest(system: System) -> float:
    """Time that one evaluation of a system may take [s]: 0 for a closed loop, whose steps are counted; infinite where
    nothing limits it."""
    seeds = max(1, len(optional.realisations(system).seeds))
    if isinstance(system, Called):
        return seeds * system.request.calls * (1 + system.request.retries) * longest(system.inner)
    return seeds * float(getattr(system, "longest", math.inf if isinstance(system, Slotted) else 0.0))
