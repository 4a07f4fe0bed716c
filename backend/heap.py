"""Garbage collection of the service: what it loads at its start lives as long as it does, and is not searched.

Imported first, so that loading the service (300,000 objects) is not interrupted for it. Start reading at `loaded`.
"""

from __future__ import annotations

import gc

_ENABLED = gc.isenabled()
gc.disable()


def loaded() -> None:
    """From here on only what requests make is searched for cycles, unless whoever loads this wants none searched."""
    if _ENABLED:
        gc.freeze()
        gc.enable()
