"""`clearance run FILE`: a campaign in this process, without any server, to its verdict.

The exit code is the verdict: 0 cleared, 1 violated, 2 inconclusive. Start reading at `run`.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from worker.cli import CLEARED, INCONCLUSIVE, VIOLATED, WrongInputError

if TYPE_CHECKING:
    from campaigns import Campaign
    from worker.store import Conclusion, MemoryStore

CODES = {"cleared": CLEARED, "violated": VIOLATED, "inconclusive": INCONCLUSIVE}


def run(
    file: Annotated[Path, typer.Argument(help="A campaign as YAML or JSON, or the name of one in the library.")],
    out: Annotated[
        Path | None, typer.Option(help="Folder for the results: result.json, evaluations.csv, traces.", file_okay=False)
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")] = False,
    threads: Annotated[int, typer.Option(help="Threads to fly on; 0 is one per core.", min=0, max=1024)] = 0,
) -> None:
    """Run a campaign here and print its verdict; the exit code is the verdict."""
    from worker.cli._campaign import read_campaign
    from worker.problem import CampaignUnusable
    from worker.store import MemoryStore

    campaign = read_campaign(file)
    _writable(out)
    store = MemoryStore()
    try:
        conclusion = _execute(campaign, store, threads or None, quiet=as_json)
    except CampaignUnusable as error:
        from campaigns import CampaignError

        raise CampaignError(str(file), error.problems) from None
    result = summary(campaign, store, conclusion)
    if out is not None:
        from worker.cli._results import write_results

        write_results(out, campaign, store, result)
    if as_json:
        typer.echo(json.dumps(result, indent=2, allow_nan=False))
    else:
        from worker.cli._report import print_report

        print_report(campaign, store, conclusion, out)
    raise typer.Exit(CODES[conclusion.verdict])


def summary(campaign: Campaign, store: MemoryStore, conclusion: Conclusion) -> dict[str, Any]:
    """What `--json` prints and result.json holds."""
    parts = conclusion.summary
    worst = parts["worst"]
    return {
        "verdict": conclusion.verdict,
        "reason": conclusion.reason,
        "nominal": parts["nominal"],
        "worst": None if worst is None else {k: worst[k] for k in ("cost", "margin", "parameters", "method")},
        "stages": [_stage(store, position) for position in range(len(store.stages))],
        "checks": parts["checks"],
        "statistics": parts["statistics"],
        "findings": [vars(f) for f in store.findings],
        "digest": campaign.digest,
        "seed": campaign.seed,
        "versions": {k: parts["provenance"][k] for k in ("clearance", "python", "packages", "cpu", "loop")},
    }


def _stage(store: MemoryStore, position: int) -> dict[str, Any]:
    record, columns = store.stages[position], store.evaluations(position)
    result = record.result or {}
    status = [] if columns is None else columns.status.tolist()
    best = None
    if columns is not None and status.count(0):
        best = float(columns.costs[columns.status == 0, 0].min())
    return {
        "kind": record.plan.kind,
        "method": record.plan.method,
        "best": best,
        "evaluations": len(status),
        "failed": status.count(1) + status.count(2),
        "excluded": status.count(3),
        "seconds": record.seconds,
        "stop": result.get("stop", {}).get("text"),
        "minima": result.get("minima", []),
    }


def _execute(campaign: Campaign, store: MemoryStore, threads: int | None, quiet: bool) -> Conclusion:
    from worker.runner import execute

    if quiet:
        return execute(campaign, store, threads=threads)
    from worker.cli._report import Progress

    with Progress(campaign) as shown:
        return execute(campaign, store, progress=shown.show, threads=threads)


def _writable(out: Path | None) -> None:
    if out is None:
        return
    try:
        out.mkdir(parents=True, exist_ok=True)
        probe = out / ".writable"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise WrongInputError(f"the folder {out} cannot be written: {error.strerror}") from None
