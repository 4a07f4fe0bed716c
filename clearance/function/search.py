"""`search`: checks its arguments, makes the campaign that they describe, and runs it in this process.

The campaign runs through the same stages as `clearance run`; only the system is a function of this process.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np

from clearance.function.request import Range, document_of, request_of, side_by_side
from clearance.function.result import Interrupted, Result
from clearance.function.searches import searches, stages
from worker.engine.systems.simulators.declared.function import data_paths, finite, only_loaded

MAX_SEED = 2**53


def search(
    fly: Callable[..., Any],
    parameters: Mapping[str, Range] | None = None,
    threshold: float | None = None,
    *,
    nominal: Mapping[str, float] | None = None,
    methods: Sequence[str] | Mapping[str, int] | None = None,
    budget: int | None = None,
    options: Mapping[str, Mapping[str, Any]] | None = None,
    starts: Sequence[Mapping[str, float]] | None = None,
    validation: int | None = None,
    agreement: float | None = None,
    certify: int = 300,
    workers: int | None = None,
    resume: Result | Interrupted | str | Path | None = None,
    seed: int = 1,
    sample_seed: int | None = None,
    vectorized: bool | None = None,
    progress: bool = False,
    name: str = "",
    quantity: str = "",
    unit: str = "",
    worse: Literal["low", "high"] = "low",
    result: str = "",
    reads: Sequence[str | Path] = (),
) -> Result:
    """Search for the worst case of a function, and state what may be claimed.

    fly: called as `fly(mass=..., drag=...)` with floats, returns one number; with `vectorized`, called with arrays (m,)
    and returns an array (m,). Or a function decorated with `clearance.simulator`.
    parameters: the range (low, high) of each uncertain parameter, by keyword of the function; for a decorated function,
    by default those that it declares.
    threshold: the value [unit] above which an evaluation is clear; at or below it, it is a violation.
    nominal: the nominal case; the middle of its range for a parameter that is not named.
    methods: search methods by name, or by name with the evaluations of each; None: `auto`.
    budget: evaluations of each search whose method has none of its own; if not given, 1000 for each parameter, 500 if
        methods are named.
    options: of the methods, by method: `{"direct": {"iterations": 100}}`.
    starts: points to start from, by parameter, for the methods that take some; other parameters are nominal.
    validation: evaluations that distinguish the worst cases and confirm results, in all; None: at most as many as the
        searches. A run never takes more evaluations than `Result.bound`.
    agreement: fraction of nominal minus worst within which the methods must agree; 0.05 if not given.
    certify: size of the independent random sample that bounds the probability of a violation; 0 for none.
    workers: processes side by side that call the function, which must be in a file; None: in this process, or as a
        decorated function declares.
    resume: an earlier result, an `Interrupted`, or the folder of `Result.save`; its searches are not evaluated again,
        and with a larger budget they continue.
    seed: of everything random but the independent sample. progress: bars in a terminal, an updated table in a notebook.
    name: of the campaign.
    sample_seed: of the independent sample, to repeat an earlier result; nothing is cleared with one that was stated.
    quantity, unit: of the returned number, for sentences, tables and axes. worse: only "low".
    result: which result of a decorated function decides, if it has several.
    reads: the data files that the function reads, or folders of them, relative to its file, or to the working folder if
        it has none; their content is part of what identifies it. A decorated function declares them itself.

    An evaluation that raises, or returns anything but a finite number, fails with its reason, and the search goes on.
    Ctrl-C raises `Interrupted`, a KeyboardInterrupt that has what was evaluated until then.

    Raises ValueError or TypeError with a sentence before anything is evaluated if an argument cannot be used, and
    ValueError if none of the first evaluations has a value or the nominal case is excluded.
    """
    if only_loaded():
        raise RuntimeError(
            "a search was started while its file is only loaded for its functions: "
            "put the call of clearance.search under `if __name__ == '__main__':`"
        )
    budget, validation, workers, certify, seed, sample_seed, methods, options, starts = (
        _python(value) for value in (budget, validation, workers, certify, seed, sample_seed, methods, options, starts)
    )
    _plain(threshold, worse)
    _counts(budget=budget, validation=validation, workers=workers, certify=certify, seed=seed, sample_seed=sample_seed)
    if agreement is not None and not (finite(agreement) and 0.0 < agreement <= 1.0):
        raise ValueError(f"agreement must be a fraction above 0 and at most 1, given {agreement!r:.60}")
    threshold = None if threshold is None else float(threshold)
    request = request_of(fly, parameters, nominal, vectorized, quantity, unit, result, data_paths(reads))
    if workers is not None:
        request = side_by_side(request, fly, workers)
    found = searches(methods, budget, options, starts, request.ranges)
    document = document_of(request, threshold, name, stages(found, certify, validation), seed)
    if agreement is not None:
        document["agreement"] = float(agreement)
    from campaigns.sample_seed import SampleSeed
    from clearance.function.running import run

    return run(request, document, progress, None if sample_seed is None else SampleSeed(sample_seed), resume)


def _python(value: Any) -> Any:
    """The value with NumPy's numbers as Python's own."""
    if isinstance(value, np.generic | np.ndarray) and value.ndim == 0:
        return value.item()
    if isinstance(value, Mapping):
        return {name: _python(part) for name, part in value.items()}
    return [_python(part) for part in value] if isinstance(value, list | tuple) else value


def _plain(threshold: object, worse: object) -> None:
    if threshold is None or not finite(threshold):
        raise ValueError(f"threshold must be a finite number, given {threshold!r:.60}")
    if worse != "low":
        raise ValueError(
            f"worse={worse!r:.60} is not supported, a verdict needs a number that is worse when low: "
            "return the margin, such as limit - value, and give threshold=0"
        )


def _counts(**counts: object) -> None:
    """The whole numbers, of which some may be left out."""
    for label, value in counts.items():
        least = 1 if label in ("budget", "workers") else 0
        if value is None and label not in ("certify", "seed"):
            continue
        if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= MAX_SEED:
            raise ValueError(f"{label} must be a whole number of at least {least}, given {value!r:.60}")
