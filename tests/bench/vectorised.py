"""Which loops vectorise, determined from freshly compiled machine code: `python -m tests.bench.vectorised [campaign]`.

A lane loop that does not vectorise multiplies one number at a time; libm's functions are calls. What is done once per
flight may be unrolled into scalars: fewer products than lanes are let pass. Counted on x86-64 only.
"""

from __future__ import annotations

import json
import os
import platform
import subprocess
import sys
import tempfile

from campaigns import library
from worker.engine.systems.closed_loop.assemble import LANES

COUNT = """
import json, re, sys
from campaigns import library, load_file
from clearance.testing.problems import Problem
loop = Problem(load_file(library()[sys.argv[1]])).system.loop
loop.warm()
code = loop.assembly()
patterns = {
    "packed_products": r"\\bv?(?:mul|fn?m(?:add|sub)\\d*)pd\\b",
    "scalar_products": r"\\bv?(?:mul|fn?m(?:add|sub)\\d*)sd\\b",
    "packed_divisions": r"\\bv?divpd\\b",
    "scalar_divisions": r"\\bv?divsd\\b",
    "wide": r"%zmm",
    "libm": r"\\b(?:sin|cos|sincos|atan2?|asin|exp|log|pow)(?:@PLT)?$",
}
print(json.dumps({name: len(re.findall(p, code, re.MULTILINE)) for name, p in patterns.items()}))
"""


def supported() -> bool:
    """Whether the machine code can be read here."""
    return platform.machine() in ("x86_64", "AMD64")


def counts(campaign: str) -> dict[str, int]:
    """Instructions by kind in the loop of a library campaign; compiles it in a process with an empty cache."""
    with tempfile.TemporaryDirectory() as empty:
        environment = os.environ | {"NUMBA_CACHE_DIR": empty}
        command = [sys.executable, "-c", COUNT, campaign]
        done = subprocess.run(command, check=True, capture_output=True, text=True, env=environment)
    found: dict[str, int] = json.loads(done.stdout)
    return found


def vectorises(found: dict[str, int]) -> bool:
    """Whether every loop over the lanes did."""
    return found["packed_products"] > 0 and found["scalar_products"] < LANES and found["libm"] == 0


if __name__ == "__main__":
    for name in sys.argv[1:] or library():
        made = counts(name)
        print(f"{name:<28} {'vectorises' if vectorises(made) else 'SCALAR PARTS':<13} {made}", flush=True)
