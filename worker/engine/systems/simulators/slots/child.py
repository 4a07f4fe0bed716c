"""The process of a slot around a Python function: child.py READ WRITE BEGUN MODULE:FUNCTION, or FILE.py:FUNCTION.

Requests and answers travel on pipes of their own, so the function may print. The number of evaluations begun is in
memory shared with the parent: an evaluation that was never begun is not blamed for the death of its process. If the
function has an attribute `prepare`, that is called first, before the process is ready. A request for a trace calls its
attribute `traced`, if it has one, which returns an object with `results` and `trace`.
"""

from __future__ import annotations

import faulthandler
import importlib
import importlib.util
import json
import mmap
import os
import signal
import struct
import sys
import traceback
from pathlib import Path
from typing import IO, Any

LENGTH = struct.Struct("<I")


def main() -> None:
    reading, writing, shared = (int(a) for a in sys.argv[1:4])
    sys.path.remove(str(Path(__file__).resolve().parent))  # else `import program` of a function would find ours
    faulthandler.enable()
    # Where it hangs, on request: written by a handler in C, which needs no lock of the interpreter.
    faulthandler.register(signal.SIGUSR1, all_threads=False)
    for descriptor in (reading, writing, shared):
        os.set_inheritable(descriptor, False)
    begun = mmap.mmap(shared, 8)
    with os.fdopen(reading, "rb") as requests, os.fdopen(writing, "wb") as answers:
        evaluate = function(sys.argv[4])
        if prepare := getattr(evaluate, "prepare", None):
            prepare()
        serve(evaluate, requests, answers, begun)


def function(name: str) -> Any:
    """The function of a module on the path, or of a file."""
    module, _, attribute = name.rpartition(":")
    if module.endswith(".py"):
        path = Path(module).resolve()
        sys.path.insert(0, str(path.parent))
        spec = importlib.util.spec_from_file_location(path.stem, path)
        if spec is None or spec.loader is None:
            raise ImportError(f"{path} is not a Python file")
        loaded = importlib.util.module_from_spec(spec)
        sys.modules[path.stem] = loaded
        spec.loader.exec_module(loaded)
    else:
        loaded = importlib.import_module(module)
    return getattr(loaded, attribute)


def serve(evaluate: Any, requests: IO[bytes], answers: IO[bytes], begun: mmap.mmap) -> None:
    """Answer requests until the pipe closes."""
    send(answers, {"ready": True})
    count = 0
    while len(header := requests.read(LENGTH.size)) == LENGTH.size:
        request = json.loads(requests.read(LENGTH.unpack(header)[0]))
        count += 1
        begun[:8] = count.to_bytes(8, "little")
        send(answers, answered(evaluate, request))


def answered(evaluate: Any, request: dict[str, Any]) -> dict[str, Any]:
    """The answer of one evaluation: results, why it is excluded, or the error in one line, whose traceback goes to
    standard error.

    An error may carry its own line, `sentence`, and end the process after the answer, `retire`.
    """
    try:
        if request.get("trace") is True and (traced := getattr(evaluate, "traced", None)):
            return dict(plain(traced(**request["parameters"])))
        return {"results": plain(evaluate(**request["parameters"]))}
    except MemoryError:
        traceback.print_exc()
        return {"error": "it ran out of memory", "retire": True}
    except Exception as error:
        if excluded := getattr(error, "excluded", None):  # raised by what calls a user's function, never by that
            return {"excluded": str(excluded)}
        if sentence := getattr(error, "sentence", None):  # an error that was expected, in words for the user
            return {"error": str(sentence), "retire": getattr(error, "retire", False)}
        traceback.print_exc()
        return {"error": f"{type(error).__name__}: {error}"}
    except SystemExit as error:
        return {"error": f"it called sys.exit({error.code!r})"}


def plain(value: Any) -> Any:
    """Numbers of numpy as those of Python at every depth; other values as they are."""
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(v) for v in value]
    if hasattr(value, "tolist"):
        return value.tolist()
    return value


def send(answers: IO[bytes], message: dict[str, Any]) -> None:
    try:
        text = json.dumps(message).encode()
    except (TypeError, ValueError) as error:
        text = json.dumps({"error": f"its result cannot be written as JSON: {error}"}).encode()
    answers.write(LENGTH.pack(len(text)) + text)
    answers.flush()


if __name__ == "__main__":
    main()
