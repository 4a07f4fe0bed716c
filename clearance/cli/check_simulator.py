"""`clearance check-simulator NAME`: evaluates a simulator at a few points, without a campaign.

The exit code is 0 only if it can be used as it is: the nominal case has a value, every other one has a value or is
excluded, and results repeat bit by bit. With `--data` the measurement is stored for the estimates of the service and of
`clearance run`.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from campaigns.rules import CALLS
from clearance.cli import WrongInputError
from clearance.cli._where import DATA, Database, opened

if TYPE_CHECKING:
    from campaigns import Campaign
    from campaigns.catalogue import SimulatorEntry
    from campaigns.results.measured import Measured
    from campaigns.stored.records import Columns

MOST_UNCERTAIN = 64
"""Uncertain parameters of a campaign."""
NOT_AS_IT_IS = 1
"""Exit code of a simulator that fails at some points or does not repeat."""


def check_simulator(
    name: Annotated[str, typer.Argument(help="A simulator of this installation.")],
    points: Annotated[
        int, typer.Option(help="The nominal point and others spread over the limits; each is evaluated three times.",
                          min=2, max=1000)
    ] = 5,
    result: Annotated[str, typer.Option(help="Result to compare; default: the first one that may decide.")] = "",
    data: Annotated[
        Path | None,
        typer.Option(help="Store the measurement in the database of this folder, for estimates.",
                     envvar="CLEARANCE_DATA", file_okay=False),
    ] = None,
    database: Database = "",
) -> None:  # fmt: skip
    """Evaluate a simulator at a few points: failures, time, and whether its results repeat."""
    from campaigns.results.base import EXCLUDED, OK
    from worker.engine.stages.parts import noise

    entry = _entry(name)
    campaign = _campaign(entry, _decides(entry, result))
    if data is not None or database:
        with opened(data or DATA, database, create=True):
            pass  # one that cannot be used is reported before anything is evaluated
    measured, columns, digest = _evaluated(campaign, points)
    _declared(entry)
    if len(entry.parameters) > len(campaign.uncertain):
        typer.echo(
            f"  varied: {len(campaign.uncertain)} of {len(entry.parameters)} parameters, the first with finite limits "
            f"and at most as many as a campaign may vary, {MOST_UNCERTAIN}; the others stayed nominal"
        )
    values = sum(columns.status == OK)
    without = noise.exclusions(columns)
    decides = campaign.criterion.result
    unit = next(r.unit for r in entry.results if r.name == decides)
    typer.echo(
        f"\n{values} of {measured.evaluations} evaluations of {measured.points} points have a value of {decides}"
    )
    for reason in noise.failures(columns):
        typer.echo(f"  failed: {reason}")
    for reason, times in without.items():
        typer.echo(f"  excluded: {times}, {reason}")
    if columns.status[0] == EXCLUDED:
        typer.echo("  the nominal case is excluded: a campaign needs nominal values that the simulator evaluates")
    if measured.seconds is not None:
        typer.echo(f"time per evaluation: {measured.seconds:.3g} s")
    if measured.start_seconds is not None:
        typer.echo(f"time that the start of a process adds: {measured.start_seconds:.3g} s")
    typer.echo(measured.text if values else "whether it repeats is unknown: no evaluation has a value")
    _advise(measured, bool(values), unit)
    if values:
        _propose(measured, len(campaign.uncertain))
    if data is not None or database:
        _store(data or DATA, database, entry, digest, measured if values else None)
    if values + without.total() < measured.evaluations or columns.status[0] != OK or not measured.repeats:
        raise typer.Exit(NOT_AS_IT_IS)


def _entry(name: str) -> SimulatorEntry:
    from campaigns.checked import texts
    from worker.running.catalogue.files import unusable_simulators
    from worker.running.catalogue.installed import catalogue

    known = catalogue()
    entry = known.simulator(name)
    if entry is None:
        for problem in unusable_simulators():
            typer.echo(problem, err=True)
        names = [s.name for s in known.simulators]
        raise WrongInputError(
            f"no simulator {name!r} in this installation; {texts.known(name, names)}. CLEARANCE_SIMULATORS names the "
            "folders of simulators"
        )
    return entry


def _decides(entry: SimulatorEntry, result: str) -> str:
    low = [r.name for r in entry.results if r.worse == "low"]
    if result and result not in low:
        raise WrongInputError(
            f"--result {result}: {entry.name} has no such result that is worse when low: {', '.join(low) or 'none'}"
        )
    if not low:
        raise WrongInputError(f"no result of {entry.name} is worse when low, so none can decide a campaign")
    return result or low[0]


def _campaign(entry: SimulatorEntry, result: str) -> Campaign:
    """All of its parameters over their limits."""
    from campaigns.asked.load import load_document
    from campaigns.asked.values import LARGEST
    from worker.running.catalogue.installed import methods

    ranges = {
        f"simulator.{p.name}": {"low": p.low, "high": p.high}
        for p in entry.parameters
        if -LARGEST <= p.low < p.high <= LARGEST
    }
    if not ranges:
        raise WrongInputError(f"no parameter of {entry.name} has finite limits with low below high: nothing can vary")
    return load_document(
        {
            "name": "check-simulator",
            "simulator": {"name": entry.name},
            "uncertain": dict(list(ranges.items())[:MOST_UNCERTAIN]),
            "criterion": {"result": result, "threshold": 0.0},
            "stages": {"sensitivity": None, "search": [{"method": next(iter(methods())), "evaluations": 1}]},
        }
    )


def _evaluated(campaign: Campaign, points: int) -> tuple[Measured, Columns, str]:
    """What was measured, the evaluations, and the digest of what was evaluated."""
    from campaigns import CampaignError
    from worker.engine.problem.evaluate import InProcess
    from worker.engine.stages.parts import noise
    from worker.engine.stages.parts.base import drive
    from worker.engine.stages.parts.context import Context
    from worker.engine.systems import optional
    from worker.engine.systems.base import CampaignUnusable
    from worker.running.opening import opened as simulators
    from worker.running.runs.store import MemoryStore

    try:
        problem = simulators.problem(campaign)
    except CampaignUnusable as error:
        raise CampaignError(
            f"the simulator {campaign.simulator.name if campaign.simulator else ''}", error.problems
        ) from None
    evaluate = InProcess(problem)
    try:
        optional.warm(problem.system)
        chosen = noise.points(problem, points)
        columns = drive(
            Context(campaign, problem, evaluate, MemoryStore()), 0, noise.measuring(problem, chosen), 2**62
        ).columns
        assert columns is not None
        return noise.measured(columns, points, problem), columns, problem.system.digest
    finally:
        evaluate.close()
        optional.close(problem.system)


def _declared(entry: SimulatorEntry) -> None:
    typer.echo(f"{entry.name}: {entry.title}")
    for p in entry.parameters:
        typer.echo(f"  parameter {p.name}: nominal {p.default:g}, {p.low:g} to {p.high:g} {p.unit}".rstrip())
    for r in entry.results:
        typer.echo(f"  result {r.name} [{r.unit or '1'}], worse when {r.worse}")


def _store(data: Path, database: str, entry: SimulatorEntry, digest: str, measured: Measured | None) -> None:
    """Store the measurement for estimates; None: no evaluation had a value."""
    from backend.db import costs

    if measured is None or measured.call_seconds is None:
        typer.echo(
            "no measurement is stored: " + ("no evaluation has a value" if measured is None else "no time was measured")
        )
        return
    with opened(data, database, create=True) as writer:
        costs.store(writer, entry, digest, measured)
    where = "the database of --database" if database else f"{data.absolute() / 'clearance.sqlite3'}"
    typer.echo(f"stored for the estimates of the launch page and of clearance run: {where}")


def _propose(measured: Measured, parameters: int) -> None:
    """The command that proposes methods and budgets for the time that was measured."""
    if measured.call_seconds is not None:
        options = f"--cost {measured.call_seconds:.3g} --parameters {parameters} --slots {measured.slots}"
        if measured.start_seconds:
            options += f" --start {measured.start_seconds:.3g}" + (f" --recycle {n}" if (n := measured.recycle) else "")
        typer.echo(f"methods and budgets for it: clearance propose {options}")


def _advise(measured: Measured, values: bool, unit: str) -> None:
    if not values or measured.repeats:
        return
    if not measured.identical and not measured.spread:
        typer.echo("Its values do not differ, but some calls fail: several calls do not help, find the cause.")
        return
    deviation = f"{measured.deviation or 0.0:.3g} {unit}".rstrip()
    typer.echo(
        "It does not repeat, so single evaluations never clear a campaign. Proposal, below `simulator`:\n"
        f"  repeats: {{count: {CALLS[0][1]}, combine: worst}}\n"
        f"and up to {CALLS[-1][1]} where the margin is less than ten times the standard deviation of {deviation}."
    )
    if measured.by_process:
        typer.echo("Evaluations in one process repeat, but differ in another: set recycle: 1 in its descriptor.")
