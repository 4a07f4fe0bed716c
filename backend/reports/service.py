"""The report of a run as one self-contained page: stored numbers and inline figures."""

from __future__ import annotations

import base64
import functools
import hashlib
import secrets
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import jinja2
import sqlalchemy as sa
from markupsafe import Markup

from backend.db.engine import one_snapshot
from backend.http.naming import named
from backend.reports import charts, limits, sections, validation, words
from backend.reports.cache import Kept, Page, key
from backend.reports.numbers import printed
from backend.reports.record import Record, load
from campaigns.claims import numbers
from campaigns.claims.say import say
from campaigns.identity.identity import Identity
from campaigns.results import TraceHead
from campaigns.results.verdict import headline
from campaigns.runs import RunState
from campaigns.stages.plan import most
from campaigns.version import VERSION
from campaigns.versions import Processor, Versions

HERE = Path(__file__).parent
FONTS = (
    ("Inter Variable", "inter-latin-wght-normal", "U+0-24F,U+2000-22FF"),
    ("Inter Variable", "inter-greek-wght-normal", "U+370-3FF"),
)
"""Font family, prefix of its file name among the built pages, Unicode range."""

UNRECORDED = "not stored when the run began"
ELSEWHERE = " on other machines, whose processors are not recorded"
_VERDICTS = {
    "cleared": ("ok", "Cleared", "M20 6 9 17l-5-5"),
    "violated": ("bad", "Violated", "M18 6 6 18M6 6l12 12"),
    "inconclusive": ("unk", "Inconclusive", "M9 9a3 3 0 1 1 4 2.8c-.7.4-1 1-1 1.9M12 17v.01"),
}
_STATES = {
    RunState.QUEUED: "The run has not started. No claim is made.",
    RunState.RUNNING: "The run is not finished. No claim is made; the numbers below are preliminary.",
    RunState.CANCELLING: "The run is being cancelled. No claim is made; the numbers below are preliminary.",
    RunState.CANCELLED: "The run was cancelled early. No claim is made; the numbers below are those found until then.",
    RunState.FAILED: "The run failed. No claim is made; the failure is not evidence about the avoidance system.",
    RunState.DONE: "The run ended without a verdict. No claim is made.",
}


KEPT = Kept()
_DAY, _MOMENT = (f"{secrets.token_hex(16)}-{name}" for name in ("day", "moment"))
"""Stand for the time of creation in a kept report; drawn, so that no text of a user contains them."""


def report_html(reader: sa.Connection, run_id: int, at: float, pages: Path, extends: str | None = None) -> Page:
    """The current report; `at` is its time of creation [s since 1970]; fonts from the built pages, if present.

    extends: what the run extends, if that is no run of this database.
    """
    known = key(reader, run_id, pages)
    page = KEPT.get(run_id, known) if extends is None else None
    if page is None and extends is not None:
        page = _written(replace(load(reader, run_id), extends=extends), pages)
    elif page is None:
        page = _written(load(reader, run_id), pages)
        # Else something may have changed while it was read.
        if one_snapshot(reader) or key(reader, run_id, pages) == known:
            KEPT.put(run_id, known, page)
    return replace(page, html=page.html.replace(_DAY, words.day(at)).replace(_MOMENT, words.moment(at)))


def _written(record: Record, pages: Path) -> Page:
    """The report without its time of creation."""
    style = _fonts(pages) + (HERE / "report.css").read_text(encoding="utf-8") + _margins(record)
    digest = base64.b64encode(hashlib.sha256(style.encode()).digest()).decode()
    policy = (
        f"default-src 'none'; style-src 'sha256-{digest}'; font-src data:; img-src data:; base-uri 'none'; "
        "form-action 'none'"
    )
    html = (
        _environment().get_template("report.html.j2").render(**_context(record), style=Markup(style), policy=policy)
    )  # the style contains no text written by users
    return Page(html, policy, named(record.run.id, record.run.name, "safety-case-report"))


def _context(record: Record) -> dict[str, object]:
    run, verdict = record.run, record.verdict
    tone, word, icon = _VERDICTS.get(
        run.verdict or "", ("err", f"{run.state.capitalize()}: no verdict", "M12 8v5M12 16v.01")
    )
    if run.verdict == "cleared" and run.against:  # no tick, as on the pages
        tone, _, icon = _VERDICTS["inconclusive"]
    stated = verdict.statement if verdict is not None else say(run.reason or "")
    sentence = stated if run.verdict else say(_STATES[run.state])
    return {
        "run": run,
        "record": record,
        "report": printed(run.id, record.digest),
        "day": _DAY,
        "made": _MOMENT,
        "version": VERSION,
        "verdict": {
            "tone": tone,
            "word": headline(word, run, run.policy, run.against),
            "icon": icon,
            "sentence": sentence,
            "error": run.error,
            "unconfirmed": run.unconfirmed,
            "sureness": () if verdict is None or verdict.sureness is None else verdict.sureness.statement,
        },
        "scope": () if verdict is None else verdict.holds_for,
        "of": record.of,
        "parts": sections.components(record),
        "uncertain": sections.uncertain(record),
        "criteria": sections.criteria(record),
        "correlations": sections.correlations(record),
        "model": sections.model(record),
        "methods": sections.methods(record),
        "stages": sections.stages(record),
        "bound": most(record.campaign),
        "centre": sections.empty_centre(record),
        "least_covered": sections.least_covered(record),
        "findings": sections.findings(record),
        "likely": sections.likely(record),
        "since": sections.since(record),
        "validation": record.validated,
        "cases": validation.cases(record),
        "again": validation.again(record),
        "encounter": validation.encounter(record),
        "limits": limits.conditions(record),
        "validated": limits.validation(record),
        "not_validated": limits.not_validated(record),
        "not_sampled": limits.not_sampled(record),
        "checks": [] if verdict is None else verdict.checks,
        "sample": charts.sample(record),
        "certificate": record.certificate,
        "counted": next((result.counted for result in record.every if result.counted is not None), None),
        "estimate": next((result.estimation for result in record.every if result.estimation is not None), None),
        "attraction": charts.attraction(record),
        "studies": [study for result in record.every for study in result.studies.items()],
        "fig": charts.drawn(record),
        "doubts": sections.doubts(record),
        "signoffs": sections.signoffs(record),
        "not_carried": record.signoffs.not_carried,
        "flights": _flights(record),
        "origin": _origin(record),
        "w": words,
        "n": numbers,
    }


def _flights(record: Record) -> list[str]:
    approaches = [(case, case.closest) for case in record.cases]
    known = [(case, closest) for case, closest in approaches if closest is not None]
    values = [closest.value for _, closest in known]
    decimals = record.of.decimals(values, numbers.decimals_for(values))
    form = "{}: {} at {} s{}.".format
    return [
        form(case.label, record.of.formatted(at.value, decimals), numbers.fixed(at.time), _shown(case.head))
        for case, at in known
    ]


def _shown(head: TraceHead) -> str:
    realised = head.realisation
    if realised is None:
        return ""
    of = f", the lowest of {realised.seeds} realisations" if realised.seeds > 1 else ""
    return f", noise seed {realised.seed}{of}"


def _sample_seed(record: Record) -> str:
    found = (stage.result.sample_seed for stage in record.stages if stage.result is not None)
    seed = next((seed for seed in found if seed is not None), None)
    if seed is None:
        return "no sample with a seed of its own"
    return f"{seed.value}, {'stated' if seed.stated else 'drawn'} at launch"


def _origin(record: Record) -> list[tuple[str, str]]:
    versions, verdict = record.run.flown, record.verdict
    known: Versions = verdict.provenance if verdict is not None else versions or Versions()
    seed = verdict.provenance.seed if verdict is not None else None
    unknown = "not recorded"
    cpu = known.cpu or Processor()
    packages = ", ".join(f"{name} {version}" for name, version in known.packages.items())
    return [
        ("Campaign", f"sha256 {record.run.campaign_digest}"),
        ("Results", f"sha256 {record.digest}"),
        ("Components", _components(record)),
        ("Code (engine, own files, packages)", _code(record.run.identity)),
        *([] if record.run.identity is None else _files(record.run.identity)),
        *([("Begun", record.run.undigested)] if record.run.undigested else []),
        ("Seed", str(record.campaign.seed if seed is None else seed)),
        ("Sample seed", _sample_seed(record)),
        ("Clearance", known.clearance or unknown),
        ("Python", known.python or unknown),
        ("Packages", packages or unknown),
        (
            "Machine",
            ", ".join(v for v in (known.system, cpu.model, cpu.target) if v) or unknown,
        ),
        *([("Evaluated by", known.evaluator + ELSEWHERE)] if known.evaluator else []),
        *([("Command", f"{known.command} (from the campaign file)")] if known.command else []),
        ("Lanes", str(known.lanes or unknown)),
        ("Worker, attempts", f"{record.run.worker or 'none'}, {record.run.attempts}"),
        ("Submitted", f"{words.moment(record.run.created)} by {words.launched_by(record.run.owner, record.run.token)}"),
        ("Started", words.moment(record.run.started)),
        ("Finished", words.moment(record.run.finished)),
        ("Extends", record.run.continues or record.extends or "no earlier run"),
    ]


def _code(identity: Identity | None) -> str:
    if identity is None:
        return UNRECORDED
    if identity.digest is None:
        return f"not identified: {', '.join(identity.unidentified)} not stored or not read exactly"
    return f"sha256 {identity.digest}"


def _files(identity: Identity) -> Iterator[tuple[str, str]]:
    yield from ((name, f"sha256 {digest}") for name, digest in identity.digests.items())
    if identity.loop:
        yield "Compiled loop", identity.loop


def _components(record: Record) -> str:
    digest = record.run.components_digest
    return f"sha256 {digest}" if digest else "not stored: descriptions are those of the current installation"


def _margins(record: Record) -> str:
    """Header and footer of every printed page; they contain no text written by users."""
    right = "" if record.run.verdict else '@top-right{content:"No verdict: no evidence for a safety case"}'
    return (
        f'@page{{{right}@top-left{{content:"Verification report {printed(record.run.id, record.digest)}"}}'
        f'@bottom-left{{content:"Clearance {VERSION}, results sha256 {record.digest[:16]}"}}}}'
    )


@functools.lru_cache(maxsize=4)
def _fonts(pages: Path) -> str:
    """The typeface of the pages, embedded; without built pages the reader's system font is used."""
    rules = []
    for family, stem, characters in FONTS:
        file = next(iter(sorted((pages / "assets").glob(f"{stem}-*.woff2"))), None)
        if file is not None:
            data = base64.b64encode(file.read_bytes()).decode()
            rules.append(
                f'@font-face{{font-family:"{family}";font-weight:100 900;src:url(data:font/woff2;base64,{data}) '
                f'format("woff2");unicode-range:{characters}}}'
            )
    return "".join(rules)


@functools.lru_cache(maxsize=1)
def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(HERE),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["plain"] = numbers.plain
    environment.filters["exact"] = numbers.exact
    return environment
