"""What must be stored with a number so that it can be repeated: versions, machine, settings of the flight."""

from __future__ import annotations

import platform
from importlib.metadata import version
from pathlib import Path
from typing import Any

from llvmlite import binding
from numba.core.codegen import get_host_cpu_features

from worker.problem import Problem

PACKAGES = ("numpy", "scipy", "numba", "llvmlite", "nlopt")


def provenance(problem: Problem) -> dict[str, Any]:
    """Versions of the code and its packages, the processor, and how the flights are integrated."""
    return {
        "clearance": version("clearance"),
        "python": platform.python_version(),
        "packages": {name: version(name) for name in PACKAGES},
        "system": f"{platform.system()} {platform.machine()}",
        "cpu": _processor(),
        "lanes": problem.loop.lanes,
        "step": problem.step,
        "integrator": "RK4",
        "loop": problem.loop.digest,
    }


def _processor() -> dict[str, str]:
    named: str = get_host_cpu_features()  # type: ignore[no-untyped-call]
    features = sorted(f[1:] for f in named.split(",") if f.startswith("+"))
    return {"model": _model(), "target": binding.get_host_cpu_name(), "features": " ".join(features)}


def _model() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor()
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "")
