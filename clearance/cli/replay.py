"""`clearance replay RUN|FILE [CASE ...]`: evaluates findings or evaluations again, and compares the costs.

The exit code is 0 only if all of them agree: to the bit on a machine of the same kind, within 1e-9 on another; 1 if
one does not; 3 if there is nothing to compare. The comparison is `worker.running.runs.replay`.
"""

from __future__ import annotations

import json
from contextlib import ExitStack
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from campaigns.refusals import RefusalCode
from campaigns.unreadable import UNREADABLE
from clearance.cli import VIOLATED, WrongInputError
from clearance.cli._capsule import changed, described, is_capsule, of_capsule, sentence
from clearance.cli._capsule_code import permits, refuse_unused, replayed_with_its_code
from clearance.cli._code import for_replay
from clearance.cli._service import Token
from clearance.cli._where import DATA, Data, Database, Service, stored_in

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    import sqlalchemy as sa

    from campaigns.results import StageResult
    from worker.engine.problem.problem import Problem
    from worker.running.runs.block_replay import Reflown
    from worker.running.runs.replay import Recorded, Replayed


def replay(
    ctx: typer.Context,
    run: Annotated[
        str,
        typer.Argument(help="The folder of a `run --out`, the id of a stored run (R-0001), or the file of a capsule."),
    ],
    case: Annotated[
        list[str] | None,
        typer.Argument(
            help="Findings (F1) or evaluations (STAGE:INDEX, as in evaluations.csv: 2:17, direct:17); default: all "
            "findings.",
            show_default=False,
        ),
    ] = None,
    blocks: Annotated[
        int,
        typer.Option(
            "--blocks",
            min=0,
            help="Of a sample of which only a part is stored: so many of its blocks, drawn at random now, are "
            "simulated again from the seed and the indices of their draws, and the digests of all their results are "
            "compared.",
        ),
    ] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print only one JSON object.")] = False,
    data: Data = DATA,
    database: Database = "",
    service: Service = "",
    token_file: Token = "",
    allow_code: Annotated[
        bool,
        typer.Option(
            "--allow-code",
            help="Permit the source of components and the command of a simulator in a run or a capsule, which "
            "run any program as you: only for files that you trust. Without it nothing of them is executed.",
        ),
    ] = False,
) -> None:
    """Evaluate findings or evaluations of a stored run or a capsule again and compare the costs with the stored ones.

    On a machine of the kind that made the run the costs must have the same bits; on another they may differ by 1e-9.
    """
    if allow_code and is_capsule(run):
        stated = [*(["--json"] if as_json else []), *([f"--blocks={blocks}"] if blocks else [])]
        ended = replayed_with_its_code(Path(run), [run, *(case or []), *stated, "--allow-code"])
        if ended is not None:
            raise typer.Exit(ended)
    from worker.running.runs import sources as sources  # first: it records the files before they are loaded

    capsule = of_capsule(Path(run), allow_code) if is_capsule(run) else None
    if capsule is None:
        with stored_in(ctx, run, data, database, service, token_file) as stored:
            recorded = stored.load(of_folder, of_database)
    else:
        recorded = capsule.recorded
    problem = opened_here(run, recorded, for_replay(run, allow_code) if capsule is None else permits(capsule.capsule))
    if capsule is not None:
        refuse_unused(run, capsule.capsule)
    again = evaluated_again(run, recorded, problem, case or [], blocks)
    apart = [] if capsule is None else changed(capsule)
    if as_json:
        answer = {"run": run, **again.document()}
        typer.echo(json.dumps(answer if capsule is None else answer | described(capsule, apart)))
    else:
        for line in again.lines():
            typer.echo(line)
        if capsule is not None:
            typer.echo(sentence(capsule, apart))
        typer.echo(again.closing())
    raise typer.Exit(0 if again.agrees else VIOLATED)


@dataclass(frozen=True)
class Again:
    """Cases that were evaluated again. well: whether each agrees; others, elsewhere: how installation and machine
    differ from those that made the run, as clauses; noise: why costs may differ all the same, empty if they repeat."""

    problem: Problem
    found: list[Replayed]
    well: list[bool]
    others: list[str]
    elsewhere: list[str]
    noise: str
    blocks: Sequence[Reflown] = ()
    """Flown again; whether each agrees is at the end of `well`."""

    @property
    def agrees(self) -> bool:
        """Whether all of them do."""
        return all(self.well)

    def document(self) -> dict[str, object]:
        """The document that `--json` prints."""
        listed = zip(self.found, self.well, strict=False)
        cases = [_described(one, self.problem) | {"agrees": fine} for one, fine in listed]
        found = {"agrees": self.agrees, "differences": self.others + self.elsewhere, "cases": cases}
        flown = zip(self.blocks, self.well[len(cases) :], strict=True)
        return found | {"blocks": [asdict(block) | {"agrees": fine} for block, fine in flown]}

    def lines(self, all_of_them: bool = True) -> Iterator[str]:
        """A line for each case, or only for those that do not agree."""
        lines = [_line(one, self.problem) for one in self.found]
        lines += [f"{block.name}: {block.agreement}" for block in self.blocks]
        return (line for line, fine in zip(lines, self.well, strict=True) if all_of_them or not fine)

    def closing(self) -> str:
        """The last sentences."""
        from campaigns.claims.numbers import count

        kind = "other than" if self.others or self.elsewhere else "the same as"
        sentences = [f"Installation and machine are {kind} those that made the run"]
        sentences[0] += f": {'; '.join([*self.others, *self.elsewhere])}." if self.others or self.elsewhere else "."
        if self.noise:
            sentences.append(f"{self.noise}, so that another cost need not mean other code or another machine.")
        wrong, every = self.well.count(False), len(self.well)
        fine = f"All {count(every)} agree." if every > 1 else "It agrees."
        sentences.append(f"{count(wrong)} of {count(every)} do not agree." if wrong else fine)
        return " ".join(sentences)


def evaluated_again(run: str, recorded: Recorded, problem: Problem, names: Sequence[str], blocks: int = 0) -> Again:
    """Evaluate the cases of these names again, all findings without names or blocks, so many blocks of its sample, and
    close the problem."""
    from worker.engine.systems import optional
    from worker.running.runs.block_replay import reflown
    from worker.running.runs.replay import UnknownCase, agrees, cases, replayed

    with ExitStack() as ending:
        ending.callback(optional.close, problem.system)
        others, elsewhere = _compared(recorded, problem)
        try:
            found = replayed(problem, cases(recorded, problem, names)) if names or not blocks else []
            flown = reflown(recorded, problem, blocks) if blocks else []
        except UnknownCase as error:
            raise WrongInputError(f"{run} cannot be replayed: {error}", RefusalCode.NO_SUCH_CASE) from None
        noise = _noise(recorded, problem)
    agreements = [*(one.agreement for one in found), *(one.agreement for one in flown)]
    well = [agrees(agreement, not (others or elsewhere)) for agreement in agreements]
    return Again(problem, found, well, others, elsewhere, noise, flown)


def of_folder(folder: Path) -> Recorded:
    """The run that `clearance run --out` wrote."""
    from campaigns.results import Finding, earlier
    from campaigns.results.measured import Measured
    from campaigns.stages.found import stage_result
    from clearance.local.results import read_folder, versions_of
    from worker.running.runs.replay import Recorded

    try:
        campaign, store = read_folder(folder)
        stated = json.loads((folder / "result.json").read_text(encoding="utf-8"))
        evidence = folder / "evidence.json"
        results = json.loads(evidence.read_text(encoding="utf-8"))["results"] if evidence.exists() else []
        kinds = [stage.plan.kind for stage in store.stages]
        results, findings = earlier.brought_up(kinds, results, stated["findings"])
        typed = [Finding.model_validate(found) for found in findings]
        known = {at: stage_result(r) for at, r in enumerate(results) if r is not None}
        measured = (results[0] or {}).get("measured") if results else None
        noise = None if measured is None else Measured.model_validate(measured)
    except UNREADABLE as error:
        raise WrongInputError(
            f"{folder} cannot be replayed: {error}", getattr(error, "code", RefusalCode.UNREADABLE)
        ) from None
    chunks = {at: columns for at in store.chunks if (columns := store.evaluations(at)) is not None}
    plans = [stage.plan for stage in store.stages]
    drawn, seeds = _drawn(known)
    seed = store.sample_seed.value if store.sample_seed is not None else campaign.seed
    here = versions_of(folder)
    return Recorded(campaign, seed, plans, chunks, typed, here, drawn=drawn, measured=noise, seeds=seeds, results=known)


def _drawn(results: Mapping[int, StageResult | None]) -> tuple[dict[int, int], dict[int, list[int]]]:
    """The number of evaluations that drew noise from the sample's seed, and the seeds of the others, both by stage."""
    known = {at: result for at, result in results.items() if result is not None}
    drawn = {at: result.drawn for at, result in known.items() if result.seeds is None}
    return drawn, {at: result.seeds for at, result in known.items() if result.seeds is not None}


def of_database(connection: sa.Connection, run_id: int) -> Recorded:
    """The stored run."""
    from backend.db import codes
    from backend.db import continuation as stored
    from campaigns import CampaignError
    from campaigns.asked.load import load_document
    from campaigns.runs import run_name
    from worker.running.runs.replay import Recorded

    name, state = run_name(run_id), stored.state(connection, run_id)
    if state is None:
        raise WrongInputError(
            f"there is no {name} in this database; check --data, the data folder of the service", RefusalCode.NO_RUN
        )
    if stored.is_purged(connection, run_id):
        raise WrongInputError(f"{name} was purged: its evaluations and findings were deleted", RefusalCode.NO_RUN)
    try:
        campaign = load_document(state[1], name)
    except CampaignError as error:
        raise WrongInputError(f"the campaign of {name} is one of another version of Clearance: {error}") from None
    stages, versions = stored.stages(connection, run_id), stored.versions(connection, run_id)
    seed = stored.sample_seed(connection, run_id)
    drawn, seeds = _drawn({at: stage.result for at, stage in enumerate(stages)})
    return Recorded(
        campaign,
        campaign.seed if seed is None else seed.value,
        [stage.plan for stage in stages],
        stored.evaluations(connection, run_id),
        stored.findings(connection, run_id),
        versions,
        codes.modules(connection, versions.code),
        drawn,
        next((s.result.repeatability for s in stages if s.result is not None), None),
        seeds,
        {at: stage.result for at, stage in enumerate(stages)},
    )


def opened_here(run: str, recorded: Recorded, permitted: str = "") -> Problem:
    """The problem of the run in this installation. permitted: the message on code that a capsule contains."""
    from campaigns import check
    from worker.engine.systems.base import CampaignUnusable
    from worker.running.catalogue.installed import catalogue
    from worker.running.opening import opened

    problems = check(recorded.campaign, catalogue())
    try:
        if not problems:
            return opened.problem(recorded.campaign)
    except CampaignUnusable as error:
        problems = error.problems
    raise WrongInputError(
        f"{run} cannot be evaluated by this installation: {'; '.join(map(str, problems))}{permitted}",
        RefusalCode.CODE_NOT_PERMITTED if permitted else RefusalCode.NOT_EVALUABLE,
    )


def _compared(recorded: Recorded, problem: Problem) -> tuple[list[str], list[str]]:
    """What differs from the installation, and from the machine, that made the run."""
    from campaigns.identity.identity import differences, identity_of, simulator_of
    from campaigns.versions import differing
    from worker.running.runs import identity
    from worker.running.runs.provenance import versions
    from worker.running.runs.replay import other_machine

    now = versions(recorded.campaign, problem.system)
    modules = differing(dict(recorded.modules), identity.code(recorded.campaign).modules) if recorded.modules else []
    simulator = simulator_of(recorded.campaign)
    then, here = identity_of(recorded.versions, simulator), identity_of(now, simulator)
    return differences(then, here, modules), other_machine(recorded.versions, now)


def _noise(recorded: Recorded, problem: Problem) -> str:
    """Why costs may differ although nothing else does; empty if evaluations repeat."""
    from campaigns.claims.numbers import number

    measured = recorded.measured
    if measured is not None and not measured.identical:
        by = "" if measured.spread is None else f" (by up to {number(measured.spread)} {problem.unit})"
        return f"The run measured that its simulator does not repeat{by}"
    if recorded.campaign.simulator is not None and recorded.campaign.simulator.calls > 1:
        return "The campaign states several calls for each evaluation, as of a simulator that does not repeat"
    return "" if problem.system.repeatable else "The simulator declares that it does not repeat"


def _described(one: Replayed, problem: Problem) -> dict[str, object]:
    from campaigns.results.base import STATUS
    from worker.running.runs.replay import values

    then, now = values(one, problem)
    return {
        "case": one.case.name,
        "stored": {"status": STATUS[one.case.status], "values": then},
        "now": {"status": STATUS[one.status], "values": now, "reason": one.reason or None},
        "agreement": one.agreement,
    }


def _line(one: Replayed, problem: Problem) -> str:
    from campaigns.results.base import STATUS
    from worker.running.runs.replay import values

    then, now = values(one, problem)
    if then is None and now is None and one.agreement != "differs":
        return f"{one.case.name}: {STATUS[one.status]} then and now"
    unit = f" {problem.unit}" if problem.unit else ""
    why = f" ({one.reason})" if one.reason and now is None else ""
    costs = [
        STATUS[status] if value is None else f"{problem.quantity} {value[0]!r}{unit}"
        for status, value in ((one.case.status, then), (one.status, now))
    ]
    apart = "" if then is None or now is None or then[0] == now[0] else f", {now[0] - then[0]:+.3g}{unit}"
    return f"{one.case.name}: stored {costs[0]}; now {costs[1]}{why}: {one.agreement}{apart}"
