"""The process that examines a file: `python -m worker.running.examination FILE VEHICLES MARK LIMIT` prints JSON.

The line begins with the mark. The folder of the file is the first of CLEARANCE_COMPONENTS.
`worker.running.catalogue.own` starts the process and reads the line.
"""

from __future__ import annotations

import json
import os
import sys
from dataclasses import asdict
from pathlib import Path


def main(file: str, vehicles: str, mark: str, limit: str) -> None:
    """Print what was found as one line of JSON; what the file itself prints goes to standard error."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    from worker.running.examination.examine import examine

    found = examine(Path(file), json.loads(vehicles), float(limit))
    answers.write(f"\n{mark}{json.dumps(asdict(found))}\n")
    answers.flush()


if __name__ == "__main__":
    main(*sys.argv[1:5])
    os._exit(0)  # not waiting for threads that the file may have started
