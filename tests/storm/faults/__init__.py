"""Single faults: each hits a run at a stated moment; then it has to end with every bit, by itself."""

from __future__ import annotations

from tests.storm.faults import databases, disks, networks, processes, services, slots, stages

__all__ = ["FAULTS", "databases", "disks", "networks"]

FAULTS = processes.FAULTS | stages.FAULTS | slots.FAULTS | databases.FAULTS | disks.FAULTS | services.FAULTS
"""By name."""
