"""`clearance run FILE`: runs a campaign locally, without a service, to its verdict.

The exit code is the verdict: 0 cleared, 1 violated, 2 inconclusive; with a baseline, the campaign's policy may change
it (`clearance.cli._ended`). A run that fails, such as one whose simulator gives no value, ends as in a service.
"""

from __future__ import annotations

import json
import shlex
import signal
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from campaigns.refusals import RefusalCode
from campaigns.runs import RunState
from clearance.cli import INTERNAL, UnreachableError, WrongInputError, refusing
from clearance.cli import _code as code
from clearance.cli import _evaluator as evaluators
from clearance.cli import _launch as launch
from clearance.cli._ended import Case, EndedRun, Source
from clearance.cli._out import refuse_other_results, remove_earlier_results, same_folder, writable
from clearance.cli._where import DATA, Data, Database
from clearance.local import interrupt

if TYPE_CHECKING:
    from campaigns import Campaign
    from campaigns.results import Verdict
    from clearance.cli._continue import Execute
    from clearance.local.citation import Cited
    from clearance.local.likelihood import Likelihoods
    from worker.engine.stages.parts.store import Store
    from worker.running.runs.store import MemoryStore


class _FailedRunError(Exception):
    """A run cannot begin or go on; the message says why.

    lowest: the lowest value that it had found; None if there is none."""

    def __init__(self, why: str, lowest: float | None) -> None:
        super().__init__(why)
        self.lowest = lowest


def run(
    file: Annotated[
        Path | None, typer.Argument(help="A campaign as YAML or JSON, or the name of one in the library.")
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Folder for the results: result.json, evaluations.csv, traces. Those of an earlier run of the same "
            "campaign are removed when the run begins; a folder with other results or files of these names is refused.",
            file_okay=False,
        ),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print only one JSON object.")] = False,
    threads: Annotated[int, typer.Option(help="Simulation threads; 0 means one per core.", min=0, max=1024)] = 0,
    onward: Annotated[
        str,
        typer.Option(
            "--continue", metavar="RUN", show_default=False,
            help="Extend an earlier run instead: the folder of its --out, or the id of a stored run.",
        ),
    ] = "",
    budget: Annotated[
        str, typer.Option(help="With --continue: 20000 is the new budget of each extended search, +20000 adds to it.")
    ] = "",
    data: Data = DATA,
    database: Database = "",
    evaluator: evaluators.Evaluator = "",
    allow_code: code.AllowCode = False,
    label: launch.Label = None,
    baseline: launch.Baseline = None,
    sample_seed: launch.StatedSampleSeed = None,
    junit: launch.Junit = None,
    markdown: launch.Summary = None,
    sarif: launch.Sarif = None,
) -> None:  # fmt: skip
    """Run a campaign locally and print its verdict; the exit code is the verdict."""
    from worker.running.runs import sources as sources  # first: it records the files before they are loaded

    _check_options(file, onward, budget, bool(label) or baseline is not None or sample_seed is not None)
    writable(out)
    from clearance.local.results import saves

    options = launch.Launch.read(label, baseline, junit, markdown, sarif, out, saves)
    evaluators.use(evaluator)
    replaced = None if same_folder(out, onward) else out  # what is extended stays until its extension is written
    begun = partial(remove_earlier_results, replaced, file)
    execute = _executing(threads or None, quiet=as_json, begun=begun, evaluator=evaluator)
    note = ""
    try:
        if onward:
            from clearance.cli._continue import execute_continued

            code.of_results(onward, allow_code)
            campaign, store, verdict, cites, labels = execute_continued(
                onward, budget, data, database, execute, partial(refuse_other_results, replaced)
            )
            options = options._replace(labels=labels)
        else:
            assert file is not None
            campaign = code.read(file, allow_code)
            refuse_other_results(out, campaign, file)
            if options.baseline:
                from clearance.cli._baseline import compared

                if same_folder(out, options.baseline):
                    raise WrongInputError(
                        f"--out {out} is the folder of --baseline, whose results would be replaced; "
                        "give another folder",
                        RefusalCode.OPTIONS,
                    )
                campaign, note = compared(campaign, options.baseline, data, database)
                refuse_other_results(out, campaign, file)  # its campaign.json states the baseline
            announced = _announcing(execute, data, database, quiet=as_json)
            try:
                campaign, store, verdict = _fresh(file, campaign, announced, sample_seed)
            except _FailedRunError as error:
                failed = _failed(f"{error}", campaign, options, note, file, out)
                failed = replace(failed, lowest=error.lowest, unit=_unit(campaign))
                typer.echo("\n".join(filter(None, ["Failed: no verdict", failed.error, failed.unconfirmed])), err=True)
                _report(failed, options, as_json)
                raise typer.Exit(INTERNAL) from None
            cites = None
    except interrupt.InterruptedRun as stopped:
        ended = _failed(f"{stopped}", stopped.campaign, options, note, file, out)
        ended = replace(ended, state=RunState.CANCELLED, lowest=stopped.lowest, unit=_unit(stopped.campaign))
        raise _interrupted(ended, options, as_json) from None
    from clearance.local.likelihood import likelihoods
    from clearance.local.summary import summary

    likely = likelihoods(campaign, store, verdict.unit)
    result = summary(campaign, store, verdict, likely) | ({"continues": cites} if cites else {}) | code.stated(campaign)
    result |= ({"labels": options.labels} if options.labels else {}) | ({"baseline": note} if note else {})
    lost = None
    if out is not None:
        from clearance.cli._capsule import write_capsules
        from clearance.local.results import write_results

        def others(folder: Path) -> None:
            write_capsules(folder, campaign, store, code.program_of(campaign))
            code.write_description(folder, campaign)

        try:
            result["evidence_digest"] = write_results(out, campaign, store, result, others=others)
        except OSError as error:  # which does not take the verdict from the user
            why = error.strerror or error
            lost = WrongInputError(f"--out {out} cannot be written, so the results are not stored: {why}")
            out = None
    if as_json:
        typer.echo(json.dumps(result, indent=2, allow_nan=False))
    else:
        from clearance.cli._report import print_report

        print_report(campaign, store, verdict, out, cites, note, likely)
    ended = _ended(campaign, store, verdict, out, options, note, file, likely, cites)
    try:
        options.write(ended)
    except WrongInputError as error:
        raise WrongInputError("; ".join(str(one) for one in (lost, error) if one)) from None
    if lost:
        raise lost
    raise typer.Exit(ended.code)


def _ended(
    campaign: Campaign, store: MemoryStore, verdict: Verdict, out: Path | None, options: launch.Launch, note: str,
    file: Path | None, likely: Likelihoods, cites: Cited | None,
) -> EndedRun:  # fmt: skip
    from campaigns.identity.identity import identity_of, simulator_of
    from clearance.local.citation import lines as citing

    begun = _failed("", campaign, options, note, file, out)
    return replace(
        begun,
        run=(cites or {}).get("as", begun.run),
        notes=(*([] if cites is None else citing(cites)), *begun.notes),
        state=RunState.DONE,
        verdict=verdict,
        replay="" if out is None else _replay(campaign, out),
        seconds=sum(stage.seconds for stage in store.stages),
        quantity=verdict.quantity,
        unit=verdict.unit,
        threshold=campaign.criterion.threshold,
        findings=tuple(
            Case(
                *(f.label, f.granted, f.granted - campaign.criterion.threshold, f.parameters, f.cost),
                likelihood=likely.text(f.label),
                seed=f.realisation,
                confirmed=f.violates,
            )
            for f in store.found()
        ),
        identity=identity_of(verdict.provenance, simulator_of(campaign)),
    )


def _replay(campaign: Campaign, out: Path) -> str:
    """The command that evaluates a case of a run again, without the case."""
    permitted = " --allow-code" if code.program_of(campaign) else ""
    return f"clearance replay{permitted} {shlex.quote(str(out))}"


def _source(file: Path | None, options: launch.Launch) -> Source | None:
    """The campaign file, for a report that points at its lines."""
    if file is None or options.sarif is None:
        return None
    from campaigns.asked.load import read_text
    from clearance.cli._campaign import found

    return Source(str(found(file)), read_text(found(file)))


def _check_options(file: Path | None, onward: str, budget: str, launched: bool) -> None:
    if onward and launched:
        raise WrongInputError(
            "an extended run has the labels, the baseline and the sample seed of the earlier one: leave them out",
            RefusalCode.OPTIONS,
        )
    if onward and file is not None:
        raise WrongInputError("give either a campaign or --continue RUN, not both")
    if not onward and file is None:
        raise WrongInputError("give a campaign file, the name of one in the library, or --continue RUN")
    if bool(onward) != bool(budget):
        raise WrongInputError("--continue RUN and --budget +N belong together: give both")


def _fresh(
    file: Path, campaign: Campaign, execute: Execute, sample_seed: int | None
) -> tuple[Campaign, MemoryStore, Verdict]:
    from campaigns import CampaignError, check
    from campaigns.sample_seed import SampleSeed
    from worker.engine.systems.base import CampaignUnusable
    from worker.running.catalogue.installed import catalogue
    from worker.running.runs.reaches import excesses
    from worker.running.runs.store import MemoryStore

    if problems := check(campaign, catalogue()) or list(excesses(campaign)):
        if any(problem.field == "simulator.name" for problem in problems):
            code.report_unusable()
        raise CampaignError(str(file), problems)
    store = MemoryStore(sample_seed=SampleSeed.drawn() if sample_seed is None else SampleSeed(sample_seed))
    try:
        with interrupt.explained(store, campaign):
            return campaign, store, execute(campaign, store, lambda: False)
    except CampaignUnusable as error:
        raise _FailedRunError("; ".join(map(str, error.problems)), interrupt.lowest(store)) from None


def _unit(campaign: Campaign) -> str:
    """The unit of the criterion."""
    from campaigns.asked.criteria import deciding
    from worker.running.catalogue.installed import catalogue

    decides = deciding(campaign, catalogue())
    return "" if decides is None else decides.unit


def _interrupted(ended: EndedRun, options: launch.Launch, as_json: bool) -> KeyboardInterrupt:
    """Write the requested files; returns what ends the command, which states also what the run had found."""
    lost = [(ended.error or "").rstrip("."), ended.unconfirmed]
    try:
        _report(ended, options, as_json)
    except WrongInputError as error:
        lost.append(f"{error}")
    return KeyboardInterrupt(". ".join(filter(None, lost)))


def _report(ended: EndedRun, options: launch.Launch, as_json: bool) -> None:
    """Print why there is no verdict and what was found all the same, if requested, and write the requested files."""
    if as_json:
        stated = {"campaign": ended.campaign, "state": ended.state, "error": ended.error}
        typer.echo(json.dumps(stated | ({"unconfirmed": text} if (text := ended.unconfirmed) else {}), indent=2))
    options.write(ended)


def _failed(
    error: str, campaign: Campaign, options: launch.Launch, note: str, file: Path | None, out: Path | None
) -> EndedRun:
    return EndedRun(
        "" if out is None else str(out), campaign.name, RunState.FAILED, None, error, labels=options.labels,
        notes=(note,) if note else (), compared=campaign.baseline is not None or not options.baseline,
        source=_source(file, options), requirements=tuple(one.id for one in campaign.criterion.requirements),
        threshold=campaign.criterion.threshold,
    )  # fmt: skip


def _announcing(execute: Execute, data: Path, database: str, quiet: bool) -> Execute:
    """Announce what the campaign is expected to take, unless quiet, then execute it."""
    from clearance.cli._announce import announce

    def announced(campaign: Campaign, store: Store, cancelled: Callable[[], bool]) -> Verdict:
        announce(campaign, data, database)
        return execute(campaign, store, cancelled)

    return execute if quiet else announced


def _executing(threads: int | None, quiet: bool, begun: Callable[[], None], evaluator: str = "") -> Execute:
    """A function that runs a campaign into a store, with progress on the terminal unless quiet. begun: called before
    anything is simulated."""
    from worker.engine.systems.simulators.cluster.address import EvaluatorLost
    from worker.running.processes import memory
    from worker.running.runs.runner import execute

    with refusing(ValueError):
        memory.refuse()

    def executed(campaign: Campaign, store: Store, cancelled: Callable[[], bool]) -> Verdict:
        evaluators.refuse_other(evaluator, campaign)
        begun()
        try:
            with memory.bounded(threads):
                return simulated(campaign, store, cancelled)
        except MemoryError:
            raise WrongInputError(memory.sentence(), RefusalCode.TOO_LITTLE_MEMORY) from None
        except EvaluatorLost as error:
            raise UnreachableError(str(error)) from None

    def simulated(campaign: Campaign, store: Store, cancelled: Callable[[], bool]) -> Verdict:
        with interrupt.deferred(cancelled, signal.SIGTERM) as stopped:  # SIGTERM, as CI services send it
            if quiet:
                return execute(campaign, store, stopped, threads=threads)
            from clearance.local.progress import Progress

            with Progress(campaign) as shown:
                return execute(campaign, store, stopped, progress=shown.show, threads=threads)

    return executed
