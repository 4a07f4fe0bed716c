"""Runs a campaign of a simulator with the command line, in a process of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from tests.faults.processes import REPOSITORY


def run(folder: Path, campaign: Path, timeout: float = 250) -> tuple[int, Any, str]:
    """Exit code, result and what it wrote to standard error; folder: where the simulators are."""
    done = subprocess.run(
        [sys.executable, "-m", "clearance", "run", str(campaign), "--json"],
        env=os.environ | {"CLEARANCE_SIMULATORS": str(folder)}, capture_output=True, text=True, check=False,
        cwd=REPOSITORY, timeout=timeout,
    )  # fmt: skip
    return done.returncode, json.loads(done.stdout) if done.stdout.startswith("{") else None, done.stderr
