"""`clearance submit --sweep`: launches a sweep on a service and follows it to its end."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from campaigns.claims.numbers import Format, signed, written
from campaigns.claims.stages.sample import STATED_SEED
from campaigns.runs import RunState
from clearance.cli import CODES, INTERNAL, INTERRUPTED, WrongInputError
from clearance.cli._exports import save
from clearance.cli._following import plain

if TYPE_CHECKING:
    from clearance.client import Client
    from clearance.client.answers import Sweep, SweepPoint

HOW = "give a parameter and its values, such as --sweep avoider.d_0=1,2,3"
TABLE = "sweep.csv"
SOURCES = {"search": ", from a random search", "certify_stated": f",{STATED_SEED}"}
"""What a bound rests on, if its seed was not drawn at the launch."""
EXCLUDED = " of draws excluded"
STATES = (
    "queued", "running", "cancelling", "cleared", "contradicted", "violated", "inconclusive", "cancelled", "failed",
    "purged",
)  # fmt: skip
"""Of runs, in the order of the page; verdicts in place of "done", so that each run is counted once; a contradicted one
is cleared as well."""


def parsed(option: str) -> tuple[str, list[float]]:
    """The parameter and its values; `WrongInputError` if the text is anything else."""
    path, sign, values = option.partition("=")
    if not sign or not path.strip() or not values.strip():
        raise WrongInputError(f"invalid sweep {option!r}: {HOW}")
    numbers = []
    for text in values.split(","):
        try:
            number = float(text)
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            raise WrongInputError(f"invalid value {text.strip()!r} in the sweep {option!r}: {HOW}")
        numbers.append(number)
    return path.strip(), numbers


def sweep(
    service: Client,
    launch: Callable[[str, list[float]], Sweep],
    option: str,
    wait: bool,
    out: Path | None,
    as_json: bool,
) -> int:
    """Launch the sweep; returns the exit code: that of the worst of its runs. launch: over a path and its values."""
    from clearance.client import UnreachableError

    path, values = parsed(option)
    found = launch(path, values)
    if not wait:
        typer.echo(found.id)
        return 0
    page = f"{service.address}/sweeps/{found.id}"
    typer.echo(f"{found.id} ({found.runs} runs) is at {page}", err=True)
    try:
        found = _followed(service, found, quiet=as_json)
    except (KeyboardInterrupt, UnreachableError):
        typer.echo(f"{found.id} continues in the background: {page}", err=True)
        raise
    typer.echo(json.dumps(found.document, indent=2) if as_json else "\n".join(_lines(found)))
    if out is not None:
        save(out, lambda folder: service.export_sweep(found, folder / TABLE))
        typer.echo(f"{TABLE} in {out}", err=True)
    return _code(found)


def _followed(service: Client, sweep: Sweep, quiet: bool) -> Sweep:
    before = ""
    for found in service.follow_sweep(sweep):
        line = f"{sweep.id}: {_counted(found.states)}"
        if not quiet and line != before:
            typer.echo(line, err=True)
        before = line
    return found


def _counted(states: Mapping[str, int]) -> str:
    """2 cleared, of these 1 contradicted, 1 violated."""
    of = {"contradicted": "of these "}
    return ", ".join(f"{of.get(word, '')}{states[word]} {word}" for word in STATES if states.get(word))


def _lines(found: Sweep) -> list[str]:
    """One for each run, then what holds for all."""
    return [*(_line(found, point) for point in found.points), *filter(None, [found.code_warning])]


def _line(found: Sweep, point: SweepPoint) -> str:
    from campaigns.results.verdict import headline

    outcome = point.outcome
    start = f"{found.path} = {point.value:.15g} {found.unit}".rstrip() + f"  {point.run}"
    if outcome is None:
        return f"{start}  purged"
    removed = "; removed from the lists" if outcome.removed else ""
    if outcome.state != RunState.DONE:
        why = plain(" ".join(filter(None, (outcome.error, outcome.unconfirmed))))
        return f"{start}  {outcome.state}: no verdict{'; ' + why if why else ''}{removed}"
    margin = "" if outcome.margin is None else f", worst margin {signed(outcome.margin)} {outcome.unit}".rstrip()
    bound = outcome.upper_bound
    most = "" if bound is None else written(bound, form=Format.AT_MOST, digits=3)
    sure = written(outcome.confidence or 0.0, form=Format.AT_LEAST)
    against = f"; {outcome.against.rstrip('.')}" if outcome.against else ""
    source, fraction = SOURCES.get(outcome.bound_source or "", ""), outcome.excluded_fraction
    excluded = f", {written(fraction, form=Format.PROBABILITY, digits=3)}{EXCLUDED}" if fraction else ""
    sampled = "" if bound is None else f", P(violation) at most {most} ({sure} confidence{source}{excluded})"
    word = headline(str(outcome.verdict), outcome, outcome.policy, outcome.against)
    return f"{start}  {word}{margin}{sampled}{against}{removed}"


def _code(found: Sweep) -> int:
    """A violation first, then what is missing a verdict, then inconclusive; cleared only if every run is, and no other
    run speaks against any of them."""
    outcomes = [point.outcome for point in found.points]
    verdicts = {outcome.verdict for outcome in outcomes if outcome is not None and outcome.state == RunState.DONE}
    states = {"purged" if outcome is None else outcome.state for outcome in outcomes}
    if "violated" in verdicts:
        return CODES["violated"]
    if states - {RunState.DONE, RunState.CANCELLED}:
        return INTERNAL
    if RunState.CANCELLED in states:
        return INTERRUPTED
    contradicted = any(outcome is not None and outcome.against for outcome in outcomes)
    return CODES["inconclusive" if "inconclusive" in verdicts or contradicted else "cleared"]
