"""Which names a component may have."""

from __future__ import annotations

import keyword
import re
from pathlib import Path

from worker.running.examination.mistake import Mistake

NAME = re.compile(r"[a-z][a-z0-9_]{0,59}", re.ASCII)
FOLDERS = {
    "vehicle": "vehicles",
    "controller": "controllers",
    "avoider": "avoiders",
    "obstacle": "obstacles",
    "environment": "environment",
    "fault": "faults",
    "criterion": "criteria",
}
"""The folder of each kind of component that is shipped."""


def check_name(role: str, name: object, line: int = 0) -> None:
    """Raises `Mistake` for a name that cannot be used, or that a shipped component of this kind has."""
    if not isinstance(name, str) or not NAME.fullmatch(name):
        raise Mistake(
            f"the name is {name!r:.60}, expected small letters, digits and _, a letter first, such as my_robot",
            line,
        )
    if keyword.iskeyword(name):
        raise Mistake(f"the name {name!r} is a word of Python: choose another, such as my_{name}", line)
    shipped = shipped_file(role, name)
    if shipped is not None:
        raise Mistake(f"the name {name!r} is taken by the {role} of {shipped}, which is shipped: choose another", line)


def shipped_file(role: str, name: str) -> str | None:
    """The file of the shipped component of that name, relative to the installation; None if there is none."""
    root = Path(__file__).parents[3]
    file = root / "worker" / "engine" / "components" / FOLDERS[role] / f"{name}.py"
    return str(file.relative_to(root)) if file.is_file() else None
