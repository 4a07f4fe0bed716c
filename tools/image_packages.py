"""Names the packages of the container image: what the project and its extras need, without those for tests.

`tools/generated.py` writes them into `tools/image-packages.txt`, from the installed packages, which are those of
requirements.lock.
"""

from __future__ import annotations

import tomllib
from importlib.metadata import requires
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
NOT_IN_IMAGE = frozenset({"test", "node", "bluesky"})
"""Extras for tests, for building the pages, and with packages that are not locked."""


def names() -> set[str]:
    """The packages, with those that they need on this machine."""
    written = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    project = written["project"]
    extras = project["optional-dependencies"].items()
    wanted = [*project["dependencies"], *written["build-system"]["requires"]]
    wanted += [one for extra, ones in extras if extra not in NOT_IN_IMAGE for one in ones]
    waiting = [found for one in wanted if _applies(found := Requirement(one), "")]
    done: set[tuple[str, str]] = set()
    while waiting:
        needed = waiting.pop()
        for extra in ("", *needed.extras):
            if (key := (canonicalize_name(needed.name), extra)) in done:
                continue
            done.add(key)
            more = (Requirement(one) for one in requires(needed.name) or ())
            waiting += [one for one in more if _applies(one, extra)]
    return {name for name, _ in done}


def _applies(needed: Requirement, extra: str) -> bool:
    return needed.marker is None or needed.marker.evaluate({"extra": extra})


def text() -> str:
    return "".join(f"{name}\n" for name in sorted(names()))
