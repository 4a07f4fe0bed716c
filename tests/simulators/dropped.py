"""The example docs/examples/drop, compiled into a folder as an operator installs it, and its campaign."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path
from typing import Any

import yaml

from tests.faults.processes import REPOSITORY

EXAMPLES = REPOSITORY / "docs" / "examples"
DRAWN = "drop_drawn"


def compiler() -> str | None:
    """The system's C compiler, if there is one."""
    return shutil.which("cc") or shutil.which("gcc")


def install(folder: Path, scene: bool = False) -> Path:
    """The folder that CLEARANCE_SIMULATORS names; needs a C compiler.

    scene: with what the example declares for a 3D view, under the name `DRAWN`, so that one folder may have both.
    """
    own = shutil.copytree(EXAMPLES / "drop", folder / (DRAWN if scene else "drop"))
    descriptor = own / "simulator.yaml"
    document = yaml.safe_load(descriptor.read_text(encoding="utf-8"))
    if scene:
        document |= {"name": DRAWN, "title": "Parachute drop in 3D"}
    else:
        del document["scene"]
    descriptor.write_text(yaml.safe_dump(document, sort_keys=False), encoding="utf-8")
    subprocess.run([str(compiler()), "-O2", "-o", own / "drop", own / "drop.c", "-lm"], check=True)
    return folder


def campaign(samples: int = 20, **changes: Any) -> dict[str, Any]:
    """The example's campaign with small budgets."""
    found: dict[str, Any] = yaml.safe_load((EXAMPLES / "campaigns" / "drop.yaml").read_text(encoding="utf-8"))
    methods = [{"method": name, "evaluations": 30} for name in ("direct", "differential_evolution")]
    stages = {"sensitivity": {"points": 3}, "search": methods, "certify": {"samples": samples}}
    small = {"findings": {"at_most": 1, "evaluations": 30}, "validate": {"neighbours": 3, "evaluations": 20_000}}
    return found | {"stages": stages | small} | changes
