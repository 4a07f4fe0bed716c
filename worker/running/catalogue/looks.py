"""Writes the looks of the shipped methods for the pages: `python -m worker.running.catalogue.looks FILE`.

The pages use them until they have loaded the catalogue, which includes other packages.
"""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from pathlib import Path

from campaigns.documents import JsonObject
from worker.running.catalogue.installed import methods


def shipped() -> list[JsonObject]:
    """Name, title and look of every method that is part of this package."""
    own = [m for m in methods().values() if m.search.__module__.startswith("worker.")]
    return [{"name": m.name, "title": m.title, "look": asdict(m.look)} for m in own if m.look is not None]


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(json.dumps(shipped(), indent=2) + "\n", encoding="utf-8")
