"""The process that describes a Python file: `python -m worker.running.catalogue.describing FILE` prints one line.

The line is JSON: what the decorated functions of the file declare, or why it cannot be used. Little is imported, so
that it starts quickly. `worker.running.catalogue.files` reads the line.
"""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from pathlib import Path
from traceback import walk_tb
from typing import Any

from worker.engine.systems.simulators.declared.function import declared_in, in_units, loaded

MARK = "clearance describes: "


def main(file: str) -> None:
    """Print the declarations of a file as one line of JSON."""
    try:
        functions = declared_in(loaded(Path(file)))
        found = [{"name": name, "declaration": asdict(in_units(f.declaration))} for name, f in functions.items()]
        answer: dict[str, object] = {"found": found}
    except SystemExit as error:
        answer = {"error": f"it calls sys.exit({error.code!r:.60}) when it is loaded"}
    except SyntaxError as error:
        answer = {"error": f"line {error.lineno}: SyntaxError: {error.msg}"}
    except Exception as error:
        answer = {"error": f"it cannot be imported: {_sentence(error, file)}"}
    print(f"\n{MARK}{json.dumps(answer, default=_plain)}", flush=True)


def _plain(value: Any) -> Any:
    """A value that JSON cannot represent, as plain numbers, or as text, which the checks then refuse."""
    return value.tolist() if hasattr(value, "tolist") else repr(value)


def _sentence(error: BaseException, file: str) -> str:
    """Type, message and the innermost line of the file."""
    lines = [line for frame, line in walk_tb(error.__traceback__) if frame.f_code.co_filename == file]
    text = f"{type(error).__name__}: {' '.join(str(error).split())[:300]}"
    return f"{text}, at line {lines[-1]}" if lines else text


if __name__ == "__main__":
    main(sys.argv[1])
