"""`clearance submit --sweep`: launches a sweep on a service and follows it to its end. Start reading at `sweep`."""

from __future__ import annotations

import json
import math
import uuid
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from campaigns.documents import JsonObject
from worker.cli import CODES, INTERNAL, INTERRUPTED, UnreachableError, WrongInputError

if TYPE_CHECKING:
    from worker.cli._remote import Remote

HOW = "give a parameter and its values, such as --sweep avoider.d_0=1,2,3"
TABLE = "sweep.csv"


def parsed(given: str) -> tuple[str, list[float]]:
    """The parameter and its values; `WrongInputError` if the text is anything else."""
    path, sign, values = given.partition("=")
    if not sign or not path.strip() or not values.strip():
        raise WrongInputError(f"invalid sweep {given!r}: {HOW}")
    numbers = []
    for text in values.split(","):
        try:
            number = float(text)
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            raise WrongInputError(f"invalid value {text.strip()!r} in the sweep {given!r}: {HOW}")
        numbers.append(number)
    return path.strip(), numbers


def sweep(
    remote: Remote, body: JsonObject, source: str, given: str, wait: bool, out: Path | None, as_json: bool
) -> int:
    """Launch the sweep; returns the exit code: that of the worst of its runs."""
    path, values = parsed(given)
    asked = {key: value for key, value in body.items() if key != "text"} | {"path": path, "values": values}
    found = remote.submit(asked, source, str(uuid.uuid4()), "sweeps")
    if not wait:
        typer.echo(found["id"])
        return 0
    typer.echo(f"{found['id']} ({found['runs']} runs) is at {remote.address}/sweeps/{found['id']}", err=True)
    try:
        found = _followed(remote, found["id"], quiet=as_json)
    except (KeyboardInterrupt, UnreachableError):
        typer.echo(f"{found['id']} continues in the background: {remote.address}/sweeps/{found['id']}", err=True)
        raise
    typer.echo(json.dumps(found, indent=2) if as_json else "\n".join(_lines(found)))
    if out is not None:
        remote.save(f"sweeps/{found['id']}/table.csv", out / TABLE)
        typer.echo(f"{TABLE} in {out}", err=True)
    return _code(found)


def _followed(remote: Remote, sweep: str, quiet: bool) -> JsonObject:
    before = ""
    for document in remote.sweep_followed(sweep):
        states = document["states"]
        line = f"{sweep}: " + ", ".join(f"{count} {state}" for state, count in sorted(states.items()))
        if not quiet and line != before:
            typer.echo(line, err=True)
        before = line
    return document


def _lines(found: JsonObject) -> list[str]:
    """A line for each run, in ascending order of the values."""
    return [_line(found, point) for point in found["points"]]


def _line(found: JsonObject, point: JsonObject) -> str:
    outcome = point["outcome"]
    start = f"{found['path']} = {point['value']:.15g} {found['unit']}".rstrip() + f"  {point['run']}"
    if outcome is None:
        return f"{start}  purged"
    if outcome["state"] != "done":
        return f"{start}  {outcome['state']}: no verdict{'; ' + outcome['error'] if outcome['error'] else ''}"
    margin = "" if outcome["margin"] is None else f", worst margin {outcome['margin']:.6g} {outcome['unit']}".rstrip()
    bound = outcome["upper_bound"]
    sampled = "" if bound is None else f", P(violation) at most {bound:.3g} ({outcome['confidence']:.0%} confidence)"
    return f"{start}  {outcome['verdict']}{margin}{sampled}"


def _code(found: JsonObject) -> int:
    """A violation first, then what is missing a verdict, then inconclusive; cleared only if every run is."""
    outcomes = [point["outcome"] for point in found["points"]]
    verdicts = {outcome["verdict"] for outcome in outcomes if outcome is not None and outcome["state"] == "done"}
    states = {"purged" if outcome is None else outcome["state"] for outcome in outcomes}
    if "violated" in verdicts:
        return CODES["violated"]
    if states - {"done", "cancelled"}:
        return INTERNAL
    if "cancelled" in states:
        return INTERRUPTED
    return CODES["inconclusive" if "inconclusive" in verdicts else "cleared"]
