"""One process for each evaluation: parameters in a JSON file, results in another; `child` runs it in a slot."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any

from worker.engine.systems.simulators.slots.answers import parsed

CHILD = Path(__file__).with_name("child.py")
COMMAND = "CLEARANCE_COMMAND"
"""The environment variable with the command line, as JSON."""
PARAMETERS, RESULTS, TRACE = "parameters.json", "results.json", "trace.json"


class Evaluate:
    """Evaluates by a process of its own; `traced` also asks for the trace, whose file is the null device otherwise."""

    def __call__(self, /, **parameters: float) -> Any:
        return _run(parameters, os.devnull)

    def traced(self, /, **parameters: float) -> dict[str, Any]:
        file = Path(TRACE).resolve()
        file.unlink(missing_ok=True)
        results = _run(parameters, str(file))
        if not file.exists():
            return {"results": results}
        return {"results": results, "trace": parsed(file.read_bytes(), TRACE)}


evaluate = Evaluate()


def _run(parameters: dict[str, float], trace: str) -> Any:
    """The results that the program wrote; raises an error that names what is missing.

    The program's output goes to that of the slot.
    """
    inputs, written = Path(PARAMETERS).resolve(), Path(RESULTS).resolve()
    written.unlink(missing_ok=True)
    inputs.write_text(json.dumps(parameters), encoding="utf-8")
    places = {"{parameters}": str(inputs), "{results}": str(written), "{trace}": trace}
    command = [_placed(word, places) for word in json.loads(os.environ[COMMAND])]
    done = subprocess.run(command, check=False, stdin=subprocess.DEVNULL)
    if done.returncode != 0:
        how = f"exit code {done.returncode}" if done.returncode > 0 else f"signal {-done.returncode}"
        raise RuntimeError(f"the program ended with {how}")
    if not written.exists():
        raise RuntimeError(f"the program wrote no {RESULTS}")
    results = parsed(written.read_bytes(), RESULTS)
    if isinstance(results, dict) and "excluded" in results and isinstance(results["excluded"], str):
        if len(results) > 1:
            raise RuntimeError(f"{RESULTS} has both results and `excluded`; write one of them")
        from worker.engine.systems.simulators.declared.excluded import Excluded  # rarely needed, and not to start

        raise Excluded(results["excluded"])
    return results


def _placed(word: str, places: dict[str, str]) -> str:
    for name, path in places.items():
        word = word.replace(name, path)
    return word
