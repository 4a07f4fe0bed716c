"""A run as SARIF 2.1.0 (OASIS, "Static Analysis Results Interchange Format"): violations, failed checks, changes.

A result points at the line of the criterion in the campaign file, and names the ranges of the parameters as related
locations.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any
from urllib.parse import quote

import yaml

from campaigns.claims.numbers import limit, signed
from campaigns.codes import CheckCode
from campaigns.results.regression import FindingChange, Standing
from campaigns.results.verdicts import DescribedCheck
from campaigns.version import VERSION
from clearance.cli._ended import Case, EndedRun, Source, read, sureness

SCHEMA = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
VIOLATION, CHECK, CHANGE, NO_VERDICT, CONTRADICTED = "violation", "check/", "change/", "no-verdict", "contradicted"
WHERE: Mapping[str, tuple[str, ...]] = {
    CheckCode.SEARCH: ("stages.search",),
    CheckCode.AGREEMENT: ("agreement", "stages.search"),
    CheckCode.SAMPLE: ("stages.certify", "stages"),
    CheckCode.OUTSIDE: ("uncertain",),
    CheckCode.PROBABILITY: ("stages.certify",),
    CheckCode.TARGET: ("target_probability", "stages.certify"),
    CheckCode.CLOSEST_APPROACH: ("encounter", "scenario"),
    CheckCode.MOTION: ("scenario",),
    CheckCode.AVOIDANCE: ("scenario.avoider", "scenario"),
    CheckCode.INFLUENCE: ("uncertain",),
    CheckCode.CALLS: ("simulator",),
}
"""The part of a campaign that a check is about; the criterion for all others."""
BASELINE = {Standing.NEW: "new", Standing.SAME: "unchanged", Standing.FIXED: "absent"}
"""SARIF's words for what has become of a finding; `updated` for all others."""


def write(file: Path, ended: EndedRun) -> None:
    file.write_text(json.dumps(sarif(ended), indent=2, ensure_ascii=False) + "\n", encoding="utf-8")


def sarif(ended: EndedRun) -> dict[str, object]:
    """The log, with one run."""
    results = list(_results(ended, {} if ended.source is None else lines(ended.source.text)))
    rules = list({str(result["ruleId"]): None for result in results})
    titles = {_named(check): check.title for check in ended.checks}
    for result in results:
        result["ruleIndex"] = rules.index(str(result["ruleId"]))
    driver = {"name": "Clearance", "version": VERSION, "rules": [_rule(name, titles) for name in rules]}
    stated: dict[str, object] = {
        "tool": {"driver": driver},
        "automationDetails": {"id": f"clearance/{quote(ended.campaign, safe='')}/{quote(ended.run, safe='')}"},
        "columnKind": "unicodeCodePoints",
        "invocations": [_invocation(ended)],
        "results": results,
        "properties": _properties(ended),
    }
    return {"$schema": SCHEMA, "version": "2.1.0", "runs": [stated]}


def _rule(name: str, titles: Mapping[str, str]) -> dict[str, object]:
    title = {
        VIOLATION: "A case within the bounds violates the criterion",
        NO_VERDICT: "The run ended without a verdict",
        CONTRADICTED: "Other runs speak against the verdict",
    }.get(name) or (
        f"Check: {titles[name]}" if name in titles else f"Change since the baseline: {name.removeprefix(CHANGE)}"
    )
    return {"id": name, "shortDescription": {"text": title}}


def _named(check: DescribedCheck) -> str:
    """The name of a rule, such as check/closest-approach."""
    return f"{CHECK}{str(check.code).replace(' ', '-')}"


def _invocation(ended: EndedRun) -> dict[str, object]:
    """Whether there is a verdict: a run without one is no evidence that anything was fixed."""
    found: dict[str, object] = {"executionSuccessful": ended.verdict is not None}
    if ended.outcome:
        found["exitCode"] = ended.code
    if ended.verdict is None:
        message = {"text": ended.no_verdict}
        found["toolExecutionNotifications"] = [{"level": "error", "message": message}]
    return found


def _properties(ended: EndedRun) -> dict[str, object]:
    verdict = ended.verdict
    stated: dict[str, object] = {
        "run": ended.run,
        "state": ended.state,
        "labels": ended.labels or None,
        "notes": list(ended.notes) or None,
        "against": list(ended.against_runs) or None,
        "code": None if ended.identity is None else ended.identity.model_dump(mode="json"),
    }
    if verdict is not None:
        stated |= {
            "verdict": str(verdict.verdict),
            "headline": ended.headline,
            "reason": verdict.reason,
            "scope": verdict.scope,
            "sureness": " ".join(sureness(verdict)),
        }
        stated |= {"campaignDigest": verdict.provenance.digest, "seed": verdict.provenance.seed}
    return {name: value for name, value in stated.items() if value not in (None, "")}


def _results(ended: EndedRun, known: Mapping[str, Place]) -> Iterator[dict[str, object]]:
    if ended.verdict is None:
        text = ended.no_verdict
        yield _result(ended, known, NO_VERDICT, "", "error", text[:1].upper() + text[1:], ())
        return
    violated = ended.verdict.verdict == "violated"
    for case in ended.violating:
        confirmed = violated and case.confirmed
        level = "note" if ended.accepted else "error" if confirmed else "warning"
        result = _result(ended, known, VIOLATION, case.label, level, _violation(ended, case), ("criterion",))
        result["relatedLocations"] = _ranges(ended, known, case.parameters)
        result["properties"] = {"cost": case.cost, "margin": case.margin, "parameters": dict(case.parameters)}
        yield result
    if ended.against:
        yield _result(ended, known, CONTRADICTED, "", "warning", ended.against, ("criterion",))
    for check in ended.checks:
        if check.standing == "fails":
            paths = (*WHERE.get(str(check.code), ()), "criterion")
            level = "note" if violated else "warning"
            yield _result(ended, known, _named(check), "", level, f"{check.title}: {check.text}", paths)
    for change in () if ended.regression is None else ended.regression.failing:
        yield _changed(ended, known, change)


def _violation(ended: EndedRun, case: Case) -> str:
    unit = f" {ended.unit}" if ended.unit else ""
    threshold = "" if ended.threshold is None else f" to the threshold {limit(ended.threshold)}{unit}"
    value = f"{case.label}: {ended.quantity or 'the criterion'} = {read(case.cost, ended.threshold)}{unit}"
    reason = None if ended.verdict is None or ended.verdict.verdict == "violated" else ended.verdict.reason
    parts = [
        f"{value}, margin {signed(case.margin)}{unit}{threshold}{case.beside(ended.threshold)}.",
        f"{case.likelihood}." if case.likelihood else "",
        "" if reason is None else f"The verdict does not confirm it: {reason}",
        *(f"{path} = {value!r}" for path, value in case.parameters.items()),
        f"{ended.replay} {case.label}" if ended.replay else "",
    ]
    return "\n".join(filter(None, parts))


def _changed(ended: EndedRun, known: Mapping[str, Place], change: FindingChange) -> dict[str, object]:
    text = "\n".join(filter(None, [f"{change.text}.", ended.command(change)]))
    name = f"{CHANGE}{str(change.standing).replace(' ', '-')}"
    result = _result(ended, known, name, change.name, "error", text, ("criterion",))
    result["relatedLocations"] = _ranges(ended, known, change.parameters)
    result["baselineState"] = BASELINE.get(change.standing, "updated")
    result["properties"] = {"parameters": dict(change.parameters)}
    return result


def _result(
    ended: EndedRun, known: Mapping[str, Place], rule: str, label: str, level: str, text: str, paths: tuple[str, ...]
) -> dict[str, object]:
    """One result; its fingerprint is that of the same rule and finding in the next run of the campaign."""
    of = hashlib.sha256("\0".join((ended.campaign, rule, label)).encode()).hexdigest()
    found: dict[str, object] = {"ruleId": rule, "level": level, "message": {"text": text}}
    found["partialFingerprints"] = {"clearanceResult/v1": of}
    if ended.source is not None:
        found["locations"] = [_location(ended.source, first(known, *paths))]
    if ended.link:
        found["hostedViewerUri"] = ended.link
    return found


def _ranges(ended: EndedRun, known: Mapping[str, Place], parameters: Mapping[str, float]) -> list[dict[str, object]]:
    if ended.source is None:
        return []
    found: list[dict[str, object]] = []
    for path, value in parameters.items():
        if f"uncertain.{path}" in known:
            location: Any = _location(ended.source, known[f"uncertain.{path}"])
            found.append({"id": len(found), **location, "message": {"text": f"{path} = {value!r}"}})
    return found


def _location(source: Source, place: Place) -> dict[str, object]:
    region = {"startLine": place[0], "startColumn": place[1]}
    return {"physicalLocation": {"artifactLocation": _artifact(source.address), "region": region}}


def _artifact(address: str) -> dict[str, object]:
    """A file below the working directory by its path, as code hosts expect it; anything else by its address."""
    if "://" in address:
        return {"uri": address}
    path = Path(address).resolve()
    if path.is_relative_to(Path.cwd()):
        return {"uri": quote(path.relative_to(Path.cwd()).as_posix()), "uriBaseId": "%SRCROOT%"}
    return {"uri": path.as_uri()}


Place = tuple[int, int]
"""Line and column of a key, from 1."""


def lines(text: str) -> dict[str, Place]:
    """The line of each part of a campaign, by its path: `criterion`, `uncertain.vehicle.m`, `stages.search`.

    Empty for a text that cannot be read, which a campaign that was submitted never is.
    """
    found: dict[str, Place] = {}
    try:
        root = yaml.compose(text, Loader=yaml.SafeLoader)
    except (yaml.YAMLError, RecursionError):
        return found
    waiting: list[tuple[str, yaml.Node]] = [] if root is None else [("", root)]
    while waiting:
        path, node = waiting.pop()
        if not isinstance(node, yaml.MappingNode) or path.count(".") > 8:
            continue
        for key, value in node.value:
            if isinstance(key, yaml.ScalarNode):
                inner = f"{path}.{key.value}" if path else str(key.value)
                found.setdefault(inner, (key.start_mark.line + 1, key.start_mark.column + 1))
                waiting.append((inner, value))
    return found


def first(known: Mapping[str, Place], *paths: str) -> Place:
    """The place of the first part that the text has; its beginning if it has none of them."""
    return next((known[path] for path in paths if path in known), (1, 1))
