"""Converts results stored by versions before 0.2 to the present format: plain JSON in, plain JSON out.

In those versions the evidence of a finding was spread over five locations, joined by its label: the rows of the
findings, and `cases`, `after`, `encounter.closest` and `comparison` of the validate stage. Used only by the migration
of databases and by the audit of older folders.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from campaigns.documents import JsonObject

Document = JsonObject


def upgraded(kind: str, result: Mapping[str, Any]) -> Document:
    """A stage's result by the stage's kind; one in the present format is returned unchanged."""
    if result.get("stage") == kind:
        return dict(result)
    found: Document = {**result, "stage": kind}
    if kind == "validate":
        cases = {case.get("name"): case for case in found.pop("cases", None) or []}
        found["nominal"] = cases.get("nominal")
        found.pop("after", None)
        if found.get("encounter"):
            closest = {c.get("name"): c for c in found["encounter"].get("closest") or []}
            found["encounter"] = {**found["encounter"], "closest": _without_name(closest.get("nominal")) or {}}
    if kind == "search":
        for key in ("minima", "members", "criteria"):
            found[key] = found.get(key) or []
    return found


def brought_up(kinds: Sequence[str], results: list[Any], findings: list[Document]) -> tuple[list[Any], list[Document]]:
    """The results of all stages, by their kinds, and the findings with their own evidence."""
    last = results[-1] if results else None
    if not last or last.get("stage"):
        return results, findings
    evidence = [{**of_finding(finding["label"], last), **finding} for finding in findings]
    kinds_of = zip(kinds, results, strict=False)
    return [None if result is None else upgraded(kind, result) for kind, result in kinds_of], evidence


def of_finding(label: str, validate: Mapping[str, Any]) -> Document:
    """The evidence for one finding in an old validate result: slices, boundary, closest approach, validation."""
    after = (validate.get("after") or {}).get(label) or {}
    closest = (validate.get("encounter") or {}).get("closest") or []
    cases = validate.get("cases") or []
    return {
        "slices": after.get("slices"),
        "boundary": after.get("boundary"),
        "closest": next((_without_name(c) for c in closest if c.get("name") == label), None),
        "validation": next((dict(case) for case in cases if case.get("name") == label), None),
    }


def head(meta: Mapping[str, Any]) -> Document:
    """The header of a trace: before the clearance disc of an obstacle was stored, its radius was the threshold."""
    closest, obstacles = meta.get("closest"), meta.get("obstacles") or []
    if closest and (closest.get("value") is None or not closest.get("obstacle_position")):
        closest = None
    known = {key: value for key, value in meta.items() if value is not None}
    known["parameters"] = {path: value for path, value in (meta.get("parameters") or {}).items() if value is not None}
    return known | {
        "closest": closest,
        "obstacles": [{"free_radius": meta.get("threshold"), **obstacle} for obstacle in obstacles],
    }


def verdict(summary: Mapping[str, Any]) -> Document | None:
    """The parts of the verdict; None if there were none."""
    if not summary.get("verdict"):
        return None
    found = dict(summary)
    processor = (found.get("provenance") or {}).get("cpu")
    cpu = {"model": processor} if isinstance(processor, str) else processor
    found["provenance"] = {**(found.get("provenance") or {}), "cpu": cpu}
    return found


def _without_name(closest: Mapping[str, Any] | None) -> Document | None:
    return None if closest is None else {key: value for key, value in closest.items() if key != "name"}
