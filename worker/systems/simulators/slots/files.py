"""One process for each evaluation: parameters in a JSON file, results in another; `child` runs it in a slot."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any

CHILD = Path(__file__).with_name("child.py")
COMMAND = "CLEARANCE_COMMAND"
PARAMETERS, RESULTS = "parameters.json", "results.json"


def packed(command: list[str]) -> str:
    """A command line as the value of an environment variable."""
    return json.dumps(command)


def evaluate(**parameters: float) -> Any:
    """The results that the program wrote; raises an error that names what is missing.

    The program's output goes to that of the slot.
    """
    given, written = Path(PARAMETERS).resolve(), Path(RESULTS).resolve()
    written.unlink(missing_ok=True)
    given.write_text(json.dumps(parameters), encoding="utf-8")
    places = {"{parameters}": str(given), "{results}": str(written)}
    command = [_placed(word, places) for word in json.loads(os.environ[COMMAND])]
    done = subprocess.run(command, check=False, stdin=subprocess.DEVNULL)
    if done.returncode != 0:
        how = f"exit code {done.returncode}" if done.returncode > 0 else f"signal {-done.returncode}"
        raise RuntimeError(f"the program ended with {how}")
    if not written.exists():
        raise RuntimeError(f"the program wrote no {RESULTS}")
    return json.loads(written.read_text(encoding="utf-8"))


def _placed(word: str, places: dict[str, str]) -> str:
    for name, path in places.items():
        word = word.replace(name, path)
    return word
