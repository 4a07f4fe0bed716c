"""The files of `clearance run --out DIR`: result.json, campaign.json, evaluations.csv, a trace per case.

evaluations.npz contains the exact evaluations on the unit cube, for `clearance run --continue DIR`; evidence.json
the other evidence of the verdict, for `clearance audit DIR`.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from itertools import zip_longest
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from backend.db.rows import plain
from campaigns import Campaign, Catalogue, load_file
from campaigns.cells import Writer
from campaigns.checked.snapshot import snapshot, values_changed
from campaigns.documents import digest_of
from campaigns.refusals import RefusalCode
from campaigns.results import StageResult
from campaigns.results.base import OK, STATUS
from campaigns.results.verdict import VerdictWord
from campaigns.stages.found import stage_result
from campaigns.stages.plan import plan
from campaigns.stored.digest import Rows, evidence_digest
from campaigns.stored.records import Columns, StageRecord, Trace
from campaigns.unreadable import UNREADABLE
from campaigns.versions import Versions, short
from clearance.local import RESULT
from worker.engine.problem.problem import Problem
from worker.engine.systems.base import in_own_sign
from worker.engine.systems.simulators.declared.folder import FILE
from worker.running.catalogue.installed import catalogue
from worker.running.opening import opened
from worker.running.runs.continuation import CannotContinue
from worker.running.runs.store import MemoryStore

ARRAYS, TABLE = "evaluations.npz", "evaluations.csv"
CAMPAIGN = "campaign.json"
OF_EVERY_RUN = (CAMPAIGN, TABLE, ARRAYS, "evidence.json")
"""The files that every run has, besides result.json."""
_OF_SOME = re.compile(r"trace-(nominal|F[0-9]+)\.csv|capsule-F[0-9]+\.zip")


def write_results(
    folder: Path, campaign: Campaign, store: MemoryStore, result: dict[str, object], problem: Problem | None = None,
    known: Catalogue | None = None, others: Callable[[Path], None] = lambda folder: None,
) -> str:  # fmt: skip
    """Write everything into the folder, numbers with all their digits; returns the evidence digest.

    What an earlier run left there is replaced when all is written; until then nothing of it is changed. In a folder
    without result.json there is nothing of an earlier run.
    problem, known: the campaign's problem and the catalogue, if its system is not one of this installation; others:
    writes what else belongs to these results into a folder.
    """
    with TemporaryDirectory(prefix=".results-", dir=folder) as beside:
        part = Path(beside)
        digest = _written(part, campaign, store, result, problem, known)
        others(part)
        earlier = _of_some(folder) if (folder / RESULT).exists() else []
        (folder / RESULT).unlink(missing_ok=True)  # without it the folder is no result, whatever interrupts the rest
        for file in earlier:
            file.unlink(missing_ok=True)
        for file in sorted(part.iterdir(), key=lambda file: file.name == RESULT):
            file.replace(folder / file.name)
    return digest


def remove_results(folder: Path, source: Path | None = None) -> None:
    """Remove the files of an earlier run, if the folder has its result.json. The campaign file `source` stays, and
    whatever else is in the folder."""
    if not (folder / RESULT).exists():
        return
    files = [*(folder / name for name in OF_EVERY_RUN), *_of_some(folder)]
    (folder / RESULT).unlink()
    for file in files:
        if source is None or not (file.exists() and source.exists() and file.samefile(source)):
            file.unlink(missing_ok=True)


def _of_some(folder: Path) -> list[Path]:
    """The files of an earlier run that not every run has. A simulator.yaml that it did not write is the user's."""
    described = [folder / FILE] if versions_of(folder).command else []
    return [*(file for file in folder.iterdir() if _OF_SOME.fullmatch(file.name)), *described]


def saves(name: str) -> bool:
    """Whether a run may write a file of this name into its folder."""
    return name in (*OF_EVERY_RUN, RESULT, FILE) or _OF_SOME.fullmatch(name) is not None


def of_others(folder: Path, campaign: Campaign | None = None) -> list[str]:
    """Names of files in a folder without result.json that a run may replace. campaign: one that is to be run; a
    campaign.json that has just its text is left out."""
    of_every = [name for name in OF_EVERY_RUN if os.path.lexists(folder / name)]
    with suppress(OSError):
        if campaign is not None and (folder / CAMPAIGN).read_bytes() == _text(campaign).encode():
            of_every.remove(CAMPAIGN)
    return [*of_every, *sorted(file.name for file in folder.iterdir() if _OF_SOME.fullmatch(file.name))]


def _written(
    folder: Path, campaign: Campaign, store: MemoryStore, result: Mapping[str, object], problem: Problem | None,
    known: Catalogue | None,
) -> str:  # fmt: skip
    (folder / CAMPAIGN).write_text(_text(campaign), encoding="utf-8")
    tables = {TABLE: folder / TABLE}
    _write_evaluations(tables[TABLE], problem or opened.problem(campaign), store)
    _write_bits(folder / ARRAYS, store)
    for trace in store.traces.values():
        name = f"trace-{trace.name}.csv"
        tables[name] = folder / name
        _write_trace(tables[name], trace)
    sums = {name: hashlib.sha256(path.read_bytes()).hexdigest() for name, path in tables.items()}
    document = evidence(campaign, store, known) | {"files": sums}
    (folder / "evidence.json").write_text(json.dumps(document, allow_nan=False) + "\n", encoding="utf-8")
    digest = _digest(campaign, store, json.loads(json.dumps({"result": result, **document})))
    sealed = {**result, "evidence_digest": digest}
    (folder / RESULT).write_text(json.dumps(sealed, indent=2, allow_nan=False) + "\n", encoding="utf-8")
    return digest


def _text(campaign: Campaign) -> str:
    return json.dumps(campaign.document(), indent=2) + "\n"


def _digest(campaign: Campaign, store: MemoryStore, documents: Any) -> str:
    """The evidence digest of what is written, as it will be read."""
    stored = ((k, store.evaluations(k)) for k in range(len(store.stages)))
    rows = [Rows.of(k, c.points, c.costs, c.status) for k, c in stored if c is not None]
    return evidence_digest(digest_of(campaign.document()), rows, documents)


def evidence(campaign: Campaign, store: MemoryStore, known: Catalogue | None = None) -> dict[str, object]:
    """The evidence behind the result: every stage's own result, and the description of the campaign's components."""
    return {
        "results": [plain(stage.result) for stage in store.stages],
        "components": snapshot(campaign, known or catalogue()).model_dump(mode="json"),
    }


@contextmanager
def _readable(what: str) -> Iterator[None]:
    """Raise `CannotContinue` for what is missing or damaged; `what` starts the sentence."""
    try:
        yield
    except UNREADABLE as error:
        why = f"{what} cannot be read ({error}); run the campaign again"
        raise CannotContinue(why, RefusalCode.UNREADABLE) from None


def read_folder(folder: Path) -> tuple[Campaign, MemoryStore]:
    """The campaign and the evaluations that `write_results` left; raises `CannotContinue` if they are missing."""
    for name in (CAMPAIGN, RESULT, ARRAYS):
        if not (folder / name).is_file():
            raise CannotContinue(
                f"it contains no {name}; give the folder of a `clearance run --out`, or a run such as R-0001",
                RefusalCode.NO_RUN,
            )
    campaign = load_file(folder / CAMPAIGN)
    planned = plan(campaign)
    with _readable(f"{ARRAYS} in it"):
        chunks = _read_bits(folder / ARRAYS, len(planned))
    with _readable("its results"):
        results = _results(folder)
    stages = [StageRecord(stage, result=result) for stage, result in zip_longest(planned, results[: len(planned)])]
    seeds = [result.sample_seed for result in results if result is not None]
    seed = next((seed for seed in seeds if seed is not None), None)
    return campaign, MemoryStore(
        stages=stages, chunks={at: [columns] for at, columns in chunks.items()}, sample_seed=seed
    )


def _results(folder: Path) -> list[StageResult | None]:
    """The results of the stages; none in a folder of an earlier version."""
    file = folder / "evidence.json"
    results = json.loads(file.read_text(encoding="utf-8")).get("results", ()) if file.exists() else ()
    return [stage_result(result) if result else None for result in results]


def versions_of(folder: Path) -> Versions:
    """The versions behind the run of a folder, as far as stored there."""
    try:
        return Versions.of(json.loads((folder / RESULT).read_text(encoding="utf-8"))["versions"])
    except UNREADABLE:
        return Versions()


def violated(folder: Path) -> bool:
    """Whether the verdict of the run of a folder is violated."""
    with _readable("its results"):
        return bool(json.loads((folder / RESULT).read_text(encoding="utf-8")).get("verdict") == VerdictWord.VIOLATED)


def components_of(folder: Path) -> Catalogue | None:
    """The components of the run of a folder; None where an earlier version stored none."""
    file = folder / "evidence.json"
    evidence = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
    return Catalogue.model_validate(evidence["components"]) if "components" in evidence else None


def refuse_other_campaign(folder: Path, campaign: Campaign) -> None:
    """Raises `CannotContinue` if the results of a folder are of another campaign, or of other components."""
    refuse_other_document(folder, campaign)
    with _readable("its results"):
        components = components_of(folder)
    refuse_other_components(campaign, components)


def refuse_other_components(campaign: Campaign, components: Catalogue | None) -> None:
    """Raises `CannotContinue` if a run of the campaign was of other components than those installed."""
    others = [] if components is None else values_changed(campaign, components, catalogue())
    if others:
        raise CannotContinue(
            f"its evaluations used different components: {'; '.join(others)}", RefusalCode.OTHER_COMPONENTS
        )


def refuse_other_document(folder: Path, campaign: Campaign) -> None:
    """Raises `CannotContinue` if the results of a folder are of another campaign.

    Evaluations are points of the unit cube: with other bounds they would be points that were never simulated.
    """
    with _readable("its results"):
        stated = str(json.loads((folder / RESULT).read_text(encoding="utf-8"))["digest"])
    if stated != campaign.digest:
        raise CannotContinue(
            f"its campaign.json is not the campaign of its results: its digest is {short(campaign.digest)}, "
            f"result.json states {short(stated)}; restore the file, or run the changed campaign as a new one",
            RefusalCode.OTHER_CAMPAIGN,
        )


def _write_bits(path: Path, store: MemoryStore) -> None:
    arrays: dict[str, Any] = {}
    for position in range(len(store.stages)):
        columns = store.evaluations(position)
        if columns is not None:
            arrays |= {
                f"{name}_{position}": getattr(columns, name) for name in ("points", "costs", "status", "seconds")
            }
            arrays[f"reasons_{position}"] = np.array(json.dumps(columns.reasons))
    np.savez(path, **arrays)


def _read_bits(path: Path, stages: int) -> dict[int, Columns]:
    found = {}
    with path.open("rb") as file, np.load(file, allow_pickle=False) as arrays:
        for at in range(stages):
            if f"points_{at}" in arrays:
                points, costs, status, seconds = (arrays[f"{n}_{at}"] for n in ("points", "costs", "status", "seconds"))
                reasons = {int(i): why for i, why in json.loads(str(arrays[f"reasons_{at}"])).items()}
                found[at] = Columns(points, costs, status, seconds, reasons)
    return found


def _write_evaluations(path: Path, problem: Problem, store: MemoryStore) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = Writer(file)
        beside = [f"{c.name} [{c.unit}]" if c.unit else c.name for c in problem.results[1:]]
        paths = [r.path for r in problem.ranges]
        writer.writerow(["stage", "kind", "method", "index", "status", "cost", *beside, *paths, "reason"])
        for position, record in enumerate(store.stages):
            columns = store.evaluations(position)
            if columns is None:
                continue
            plan = record.plan
            values = problem.values(columns.points)
            results = in_own_sign(problem.results, columns.costs)
            for i, (status, value) in enumerate(zip(columns.status.tolist(), results.tolist(), strict=True)):
                costs = [repr(v) if status == OK else "" for v in value]
                row = [position, plan.kind, plan.method or "", i, STATUS[status], *costs]
                writer.writerow([*row, *map(repr, values[i].tolist()), columns.reasons.get(i, "")])


def _write_trace(path: Path, trace: Trace) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = Writer(file)
        writer.writerow([f"{c.name} [{c.unit}]" for c in trace.columns])
        writer.writerows([repr(v) for v in row] for row in trace.data.tolist())
