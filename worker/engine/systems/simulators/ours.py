"""Whether the files of Clearance that the process of a slot loads are still those of this process.

A slot starts minutes after this process has loaded its own code, and again for every process that is replaced: after a
release it would evaluate by other code than a run's digest states.
"""

from __future__ import annotations

from pathlib import Path

from worker.engine.systems.simulators.declared.unchanged import Unchanged

_SIMULATORS = Path(__file__).parent
FILES = [
    *sorted(_SIMULATORS.rglob("*.py")),
    *(folder / "__init__.py" for folder in _SIMULATORS.parents[:3]),
]
"""All of the package of simulators, and the packages that it is in."""

_OURS = Unchanged(FILES)
"""As they were when this module was loaded."""


def changed(now: bool = False) -> str:
    """Why no slot of this process evaluates any more, a sentence; empty while the files are as they were."""
    found = _OURS.changed(now)
    return found and "the code of Clearance that evaluates has changed since this process started; start the run again"
