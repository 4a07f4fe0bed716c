"""Installs the simulator in its own folder, and the campaigns that use it."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

REPOSITORY = Path(__file__).parents[2]
SOURCE = Path(__file__).parent / "two_basins.py"


def install(folder: Path) -> Path:
    """A package in this folder with one entry point of `clearance.simulators`."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "basins.py").write_text(SOURCE.read_text(encoding="utf-8"), encoding="utf-8")
    info = folder / "basins-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: basins\nVersion: 1.0\n", encoding="utf-8")
    (info / "entry_points.txt").write_text("[clearance.simulators]\ntwo_basins = basins\n", encoding="utf-8")
    return folder


def path(folder: Path) -> str:
    """The PYTHONPATH of a process that has the package."""
    return f"{REPOSITORY}{os.pathsep}{folder}"


def campaign(threshold: float = 5.0, **changes: Any) -> dict[str, Any]:
    """A campaign over both offsets: two searches that agree, a sample, sensitivity."""
    return {
        "name": "Two basins",
        "simulator": {"name": "two_basins"},
        "uncertain": {"simulator.x": {"low": 0.0, "high": 0.95}, "simulator.y": {"low": 0.0, "high": 0.95}},
        "criterion": {"result": "separation", "threshold": threshold},
        "stages": {
            "sensitivity": {"points": 11},
            "search": [
                {"method": "direct", "evaluations": 600},
                {"method": "genetic", "evaluations": 900},
            ],
            "certify": {"samples": 300},
            "validate": {"evaluations": 20_000},
        },
    } | changes
