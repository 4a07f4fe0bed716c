"""The argument as YAML in Goal Structuring Notation, in the form of gsn2x 4.

Only valid evidence is a solution: cleared, signed off, unchanged. What is not yet evidence is a context of an
undeveloped goal; a violation is a counter-solution that defeats the goal of its requirement, which nothing supports.
Sources: GSN Community Standard 3 (SCSC-141C), with its dialectic extension; gsn2x, "Syntax in YAML". Read `argument`.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping, Sequence
from typing import Any

import yaml

from backend.requirements.schemas import RequirementRow, RequirementRun
from backend.requirements.sheet import stamp
from backend.runs.violations import CLOSER
from backend.signoffs.schemas import signed_by
from campaigns.asked.reading import Dumper
from campaigns.claims.numbers import digits_of, signed, written
from campaigns.results.verdict import VerdictWord, headline

Element = dict[str, str | bool | list[str]]
Nodes = dict[str, Element]
"""The elements of an argument by their names."""

TOP, STRATEGY = "G-all-requirements", "S-all-requirements"
"""A dash in the middle: names of requirements have none."""
_UNSAFE = re.compile(r"[^A-Za-z0-9_]+")


class _Text(Dumper):
    """Writes lists on one line, and no aliases."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


_Text.add_representer(
    list, lambda dumper, items: dumper.represent_sequence("tag:yaml.org,2002:seq", items, flow_style=True)
)


def argument(
    rows: Sequence[RequirementRow], claims: Mapping[str, str], address: str, at: float, code: str | None
) -> str:
    """The document. claims: the sentence of each run's verdict, by its name; address: of the service; at: now."""
    nodes: Nodes = {}
    names = _names([row.id for row in rows])
    goals = [_goal(nodes, names[row.id], row, claims, address) for row in rows]
    when = stamp(at)
    met = sum(row.status == "met" for row in rows)
    top: Element = {"text": "The requirements are met, as far as the searches of the runs below can show"}
    top["status"] = "met" if rows and met == len(rows) else "not met"
    known = "not known" if code is None else f"sha256 {code}"
    context = f"Exported {when}: {met} of {len(rows)} requirements are met. Code of the workers: {known}"
    document: Nodes = {TOP: top | {"inContextOf": ["C-export", "A-search"]}}
    document["C-export"] = {"text": context, "url": f"{address}/requirements"}
    document["A-search"] = {"text": "A search is not a proof: a worse case inside the bounds remains possible"}
    if goals:
        document[TOP] |= {"supportedBy": [STRATEGY]}
        document[STRATEGY] = {"text": "Argument over each requirement", "supportedBy": goals}
    else:
        document[TOP] |= {"undeveloped": True}
    return yaml.dump(document | nodes, Dumper=_Text, sort_keys=False, allow_unicode=True, width=110)


def _goal(nodes: Nodes, name: str, row: RequirementRow, claims: Mapping[str, str], address: str) -> str:
    """Add the goal of a requirement, with all that is beneath it; its name."""
    goal: Element = {
        "text": f"{row.id}: {row.text or 'no text is known'}",
        "status": row.status,
        "why": row.sentence,
    }
    nodes[f"G-{name}"] = goal
    counting = [run for run in row.runs if run.part != "other"]
    if row.status == "violated":
        goal |= {"defeated": True, "undeveloped": True}
        against = [run for run in counting if run.part == "violation"]
        for run in against:
            challenge = {"challenges": f"G-{name}"}
            nodes[f"CSn-{name}-{run.id}"] = _leaf(run, claims, address) | challenge
        rest = [_context(nodes, name, run, claims, address) for run in counting if run not in against]
        goal |= {"inContextOf": rest} if rest else {}
        return f"G-{name}"
    if not counting:
        goal |= {"undeveloped": True}
        return f"G-{name}"
    against = [run for run in counting if run.part == "violation"]
    first = {run.campaign_name: run for run in reversed(against)}
    evidence = [run for run in counting if run not in against]
    alone = [first[of] for of in first.keys() - {run.campaign_name for run in evidence}]
    subgoals = [
        _subgoal(nodes, name, run, [one for one in against if one.campaign_name == run.campaign_name], claims, address)
        for run in (*evidence, *sorted(alone, key=lambda run: run.id))
    ]
    goal |= {"supportedBy": [f"S-{name}"]}
    nodes[f"S-{name}"] = {
        "text": f"Argument over each campaign of {row.id}; the requirement is {row.status}",
        "supportedBy": subgoals,
    }
    return f"G-{name}"


def _subgoal(
    nodes: Nodes,
    name: str,
    run: RequirementRun,
    against: Sequence[RequirementRun],
    claims: Mapping[str, str],
    address: str,
) -> str:
    """Add the goal that one campaign meets its criterion, supported only by evidence that is valid.

    against: runs that found a value that would violate it, without a verdict that confirms it; the run itself may be
    one, if the campaign has no other.
    """
    key = f"{name}-{run.id}"
    above = (
        "its threshold" if run.threshold is None else written(run.threshold, run.unit, digits=digits_of(run.threshold))
    )
    goal: Element = {"text": f"{run.campaign_name}: {run.quantity or 'the criterion'} stays above {above}"}
    nodes[f"G-{key}"] = goal
    if run.verdict == "cleared" and not run.not_sampled and run.signed and not run.suspect and not against:
        nodes[f"Sn-{key}"] = _leaf(run, claims, address)
        goal |= {"supportedBy": [f"Sn-{key}"]}
    else:
        contexts = [
            _context(nodes, name, one, claims, address) for one in (run, *(one for one in against if one != run))
        ]
        goal |= {"undeveloped": True, "inContextOf": contexts}
    return f"G-{key}"


def _context(nodes: Nodes, name: str, run: RequirementRun, claims: Mapping[str, str], address: str) -> str:
    key = f"C-{name}-{run.id}"
    nodes[key] = _leaf(run, claims, address)
    return key


def _leaf(run: RequirementRun, claims: Mapping[str, str], address: str) -> Element:
    parts = [f"{run.id} is {headline(run.verdict or run.state, run, None, run.against)}"]
    if run.margin is not None:
        parts.append(f"worst margin {signed(run.margin)} {run.unit}".strip())
    if run.policy == "fails":
        parts.append("the policy of its campaign on changes since the baseline fails")
    if run.part == "violation" and (run.verdict != VerdictWord.VIOLATED or run.role.startswith(CLOSER)):
        parts.append(run.role)
    current = [one for one in run.signoffs if one.current]
    parts += [f"signed off by {signed_by(one)}, {one.sentence}" for one in current] or [
        "not signed off" if not run.signoffs else "the sign-off is of other results"
    ]
    if run.suspect:
        parts.append(f"SUSPECT: {'; '.join(run.changes)}")
    text = ", ".join(parts[:-1] if run.suspect else parts) + (f". {parts[-1]}" if run.suspect else "")
    leaf: Element = {"text": text, "claim": claims.get(run.id, ""), "digest": f"sha256 {run.campaign_digest}"}
    if run.code is not None:
        leaf["code"] = f"sha256 {run.code}"
    return leaf | {"url": f"{address}/runs/{run.id}"}


def _names(requirements: Sequence[str]) -> dict[str, str]:
    """The ids of requirements as parts of names of elements; two never share one."""
    found: dict[str, str] = {}
    taken: set[str] = set()
    for key in requirements:
        safe = _UNSAFE.sub("_", key)
        name = safe if safe == key else f"{safe}_{hashlib.sha256(key.encode()).hexdigest()[:8]}"
        while name in taken:
            name += "_"
        taken.add(name)
        found[key] = name
    return found
