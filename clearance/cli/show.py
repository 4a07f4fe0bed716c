"""`clearance show RUN`: prints a run of a service as it is now."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Annotated

import typer

from clearance.cli._ended import read
from clearance.cli._following import (
    AsJson,
    as_ended,
    case,
    counts,
    ended_as,
    moment,
    plain,
    superseded,
    verdict_lines,
    worked,
)
from clearance.cli._service import PATIENCE, SERVICE, Patience, Service, Token, numbered, opened

if TYPE_CHECKING:
    from clearance.cli._ended import EndedRun
    from clearance.client import Client
    from clearance.client.answers import Finding, RunDetail, Signoff


def show(
    run: Annotated[str, typer.Argument(help="Number of the run, such as R-0001.")],
    as_json: AsJson = False,
    service: Service = SERVICE,
    token_file: Token = "",
    patience: Patience = PATIENCE,
) -> None:
    """Print a run of a service: verdict, checks, worst cases, sign-offs. The exit code is not the verdict."""
    with opened(service, token_file, patience) as client:
        found = client.run(numbered(run))
        if as_json:
            typer.echo(json.dumps(found.document, indent=2))
            return
        findings, ended = client.findings(found), as_ended(client, found)
        parts = [*_head(found, ended), *_checks(found), *verdict_lines(ended), *_findings(found, findings)]
        parts += _likely(client, found, findings)
        signed = client.signoffs(found)
        missing = [f"Not signed off: {plain(signed.not_carried)}"] if signed.not_carried else []
        typer.echo("\n".join([*parts, *map(_signoff, signed.items), *missing, client.link(found)]))


def _head(found: RunDetail, ended: EndedRun) -> list[str]:
    from campaigns.identity.identity import Identity

    lines = [f"{found.id} {ended_as(found).capitalize()}: {plain(found.name)}"]
    stated = (found.reason, found.error, ended.unconfirmed, found.waits, superseded(found), *ended.notes)
    lines += [plain(text) for text in stated if text]
    if found.stage is not None:
        lines.append(f"Running: {found.stage.kind} {found.stage.method or ''}".rstrip())
    lines += [counts(found), f"Campaign: {plain(found.campaign_name)}, sha256 {found.campaign_digest[:16]}"]
    if (code := found.document.get("identity")) is not None:  # an earlier version of the service sends none
        lines.append(f"Code: {plain(Identity.model_validate(code).text)}")
    if begun := found.document.get("undigested"):
        lines.append(f"Code: {plain(str(begun))}")
    times = {"Submitted": found.created, "started": found.started, "ended": found.finished}
    stamps = [f"{word} {moment(at)}" for word, at in times.items() if at]
    lines.append(", ".join([*stamps, *([f"worked {seconds:.3f} s"] if (seconds := worked(found)) else [])]))
    lines.append(f"By {plain(found.owner)}" + (f" (token {found.token})" if found.token else ""))
    if found.labels:
        lines.append("Labels: " + ", ".join(f"{key}={value}" for key, value in found.labels.items()))
    return lines


def _checks(found: RunDetail) -> list[str]:
    checks = [] if found.summary is None else found.summary.checks
    return [
        f"  {check.standing:5}  {check.title}: {plain(check.text)}{f'; {plain(check.but)}' if check.but else ''}"
        for check in checks
    ]


def _findings(found: RunDetail, findings: list[Finding]) -> list[str]:
    from campaigns.claims.numbers import signed

    unit, limit = f" {found.unit}" if found.unit else "", found.threshold
    return [
        f"{f.label}: {found.quantity} {read(f.cost, limit)}{unit}, margin {signed(f.margin)}{unit}{f.beside(limit)}; "
        + ", ".join(f"{path} = {value!r}" for path, value in f.parameters.items())
        for f in map(case, findings)
    ]


def _likely(client: Client, found: RunDetail, findings: list[Finding]) -> list[str]:
    """How likely each finding is, and the most likely violation; a service of an earlier version sends neither."""
    from clearance.client import NotFoundError

    stated = {f.label: f.likelihood.text for f in findings if f.likelihood is not None}
    if not stated:
        return []
    same = set(stated.values()) if len(stated) > 1 else set()
    lines = [plain(text) for text in same] if len(same) == 1 else [f"{k}: {plain(v)}" for k, v in stated.items()]
    try:
        most = client.most_likely_violation(found)
    except NotFoundError:
        return lines
    return [*lines, *([] if most.case is None else [plain(most.text)])]


def _signoff(one: Signoff) -> str:
    typed = ", name as typed" if one.typed else ""
    return f"Signed off by {plain(one.name)} ({plain(one.role)}{typed})" + (
        f": {plain(one.sentence)}" if one.sentence else ""
    )
