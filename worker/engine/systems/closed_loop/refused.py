"""A closed loop that cannot be built or compiled, as a problem of its campaign with file, line and sentence."""

from __future__ import annotations

from pathlib import Path

import numba

from campaigns.asked.problem import Problem
from worker.engine.kernels.folder import cache_folder
from worker.engine.kernels.reduced import reduced


def by_compiler(error: BaseException) -> Problem:
    """The compiler's error at the innermost line of a component."""
    found = reduced(error, _is_component)
    where = f"{found.file}, line {found.line}: " if found.file else ""
    return Problem("scenario", Path(found.file).name, f"{where}{found.text}")


def _is_component(file: str) -> bool:
    """Whether a file may be a component's: not the compiler's, the generated loop's or that of the loop over time."""
    apart = (Path(numba.__file__).parent, cache_folder(), Path(__file__).parents[2] / "kernels")
    path = Path(file)
    return path.suffix == ".py" and path.is_file() and not any(path.is_relative_to(folder) for folder in apart)
