"""The seed of a run's independent sample: drawn when the run is launched, so that no user has chosen its points.

Whoever may try several seeds before the run finds one whose sample misses what it should show.
"""

from __future__ import annotations

import secrets
from dataclasses import dataclass

_BITS = 52
"""Every seed is a whole number that JSON keeps exactly."""
LARGEST = 2**_BITS - 1


@dataclass(frozen=True)
class SampleSeed:
    """The seed, and whether whoever launched the run stated it instead of having it drawn."""

    value: int
    stated: bool = True

    @classmethod
    def drawn(cls) -> SampleSeed:
        """A new one of the operating system's random numbers."""
        return cls(secrets.randbits(_BITS), stated=False)
