"""Discovers the stages: every module of this folder with an attribute `stage`."""

from __future__ import annotations

import importlib
import pkgutil
from functools import cache

import worker.engine.stages
from worker.engine.stages.parts.outcome import Stage


@cache
def stages() -> dict[str, Stage]:
    """Every stage by its kind; a duplicate kind is an error."""
    found: dict[str, Stage] = {}
    for info in pkgutil.iter_modules(worker.engine.stages.__path__):
        if info.ispkg or info.name == __name__.rpartition(".")[2]:
            continue
        stage = importlib.import_module(f"worker.engine.stages.{info.name}").stage
        if stage.kind in found:
            raise ValueError(
                f"worker.engine.stages.{info.name} declares {stage.kind!r}, which another module already declares"
            )
        found[stage.kind] = stage
    return found
