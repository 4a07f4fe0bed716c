"""The matrix of requirements and runs.

Rows are all ids that are registered or that a run states; a requirement without a run is a row. Only the runs that a
page shows are read in full, by the index of `run_requirements`.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import sqlalchemy as sa

from backend.db.digest import EVIDENCE
from backend.db.engine import chunks
from backend.db.sweeps import in_sweep
from backend.db.tables import CampaignRow, Requirement, RequirementFile, Run, RunRequirement
from backend.http.errors import foreign_cursor
from backend.http.matches import tag
from backend.http.schema import unstorable_text
from backend.requirements import against
from backend.requirements.schemas import RequirementPage, RequirementRow, RequirementRun
from backend.requirements.standing import Edge, Standing, standing
from backend.runs import identity
from backend.runs.outcomes import Outcome, outcomes
from backend.runs.violations import CLOSER
from backend.runs.within import judged, of_runs
from backend.signoffs import present
from backend.signoffs.standing import UNSIGNED, Signature, signatures
from backend.signoffs.texts import Texts, texts
from campaigns.identity.identity import UNSTORED
from campaigns.results.verdict import VerdictWord
from campaigns.runs import run_number


@dataclass(frozen=True)
class Known:
    """signatures: those that were not withdrawn; changes: since the run, but for texts of requirements; evidence: the
    digest that its verdict states."""

    outcome: Outcome
    signatures: list[Signature]
    not_carried: str | None
    changes: tuple[str, ...]
    evidence: str | None

    @property
    def current(self) -> list[Signature]:
        return [one for one in self.signatures if one.current]


def page(reader: sa.Connection, q: str, cursor: str | None, limit: int, runs: int) -> RequirementPage:
    """The rows after a cursor, which is an id; runs: the most of each row, besides those that count."""
    every = _ids(q).subquery()
    of = sa.select(every.c.id).order_by(every.c.id)
    if cursor is not None:
        of = of.where(every.c.id > _read(cursor))
    ids = list(reader.scalars(of.limit(limit + 1)))
    more, ids = len(ids) > limit, ids[:limit]
    now = present.present(reader, ())
    return RequirementPage(
        items=rows(reader, ids, runs),
        next_cursor=ids[-1].encode().hex() if more else None,
        total=reader.scalar(sa.select(sa.func.count()).select_from(every)) or 0,
        compared=now.installation.catalogue is not None,
    )


def every(reader: sa.Connection, runs: int) -> Iterator[RequirementRow]:
    cursor = None
    while True:
        found = page(reader, "", cursor, 200, runs)
        yield from found.items
        cursor = found.next_cursor
        if cursor is None:
            return


def rows(reader: sa.Connection, ids: Sequence[str], most: int) -> list[RequirementRow]:
    edges = _edges(reader, ids)
    others = against.against(reader, edges)
    edges, others = against.located(reader, edges, others)
    stored = sa.select(Requirement.__table__, RequirementFile.name.label("file"))
    stored = stored.outerjoin(RequirementFile, RequirementFile.id == Requirement.file_id)
    registered = {row.id: row for row in reader.execute(stored.where(Requirement.id.in_(ids)))}
    now = present.present(reader, {e.campaign for found in edges.values() for e in found})
    shown = {key: _shown(standing(found, others), found, most) for key, found in edges.items()}
    known = _known(reader, {n for found in shown.values() for n in found}, now)
    worded = texts(reader, known, ids)
    ignored, similar = against.ignored(reader, ids, edges), against.similar(reader, ids, _ids(""))
    made = []
    for key in ids:
        row, text = registered.get(key), worded.now.get(key, "")
        whole = [_whole(e, known.get(e.run_id), key, worded) for e in edges.get(key, [])]
        found = standing(whole, others, ignored[key].sweeps)
        beside = [_whole(e, known[e.run_id], key, worded) for e in others if e.run_id in known]
        by = {e.run_id: e for e in (*beside, *whole)}
        listed = shown.get(key, ())
        made.append(
            RequirementRow(
                id=key,
                text=text,
                status=found.status,
                sentence=" ".join([found.sentence, *against.notes(ignored[key], similar.get(key, []))]),
                registered=row is not None,
                file=None if row is None else row.file,
                attributes={} if row is None else row.attributes,
                changed=None if row is None else row.changed,
                changed_by=None if row is None else row.changed_by,
                etag=tag(key, None if row is None else row.text),
                runs=[_run(by[run_id], known[run_id], found, key) for run_id in listed if run_id in known],
                total=len(whole),
                unlisted=len({e.run_id for e in whole} - set(listed)),
                removed=ignored[key].removed,
                sweeps=ignored[key].sweeps,
            )
        )
    return made


def _ids(q: str) -> sa.CompoundSelect[Any]:
    stated = sa.select(RunRequirement.requirement.label("id"))
    written = sa.select(Requirement.id.label("id"))
    for word in q.split()[:10]:
        like = {"autoescape": True}
        written = written.where(
            sa.or_(Requirement.id.icontains(word, **like), Requirement.text.icontains(word, **like))
        )
        stated = stated.where(
            sa.or_(RunRequirement.requirement.icontains(word, **like), RunRequirement.text.icontains(word, **like))
        )
    return sa.union(written, stated)


def _read(cursor: str) -> str:
    try:
        text = bytes.fromhex(cursor).decode()
        if unstorable_text(text) is not None:
            raise ValueError(text)
        return text
    except ValueError:
        raise foreign_cursor(cursor) from None


def _edges(reader: sa.Connection, ids: Sequence[str]) -> dict[str, list[Edge]]:
    """The runs of each requirement that count, the newest first; what they found only where a violation may rest on
    it."""
    columns = (RunRequirement.requirement, RunRequirement.run_id, Run.question, Run.bounds, Run.state, Run.verdict)
    of = sa.select(*columns, CampaignRow.name, Run.threshold)
    of = of.join(Run, Run.id == RunRequirement.run_id)
    of = of.join(CampaignRow, CampaignRow.digest == Run.campaign_digest)
    of = of.where(RunRequirement.requirement.in_(ids), *present.counted()).order_by(RunRequirement.run_id.desc())
    found: dict[str, list[Edge]] = defaultdict(list)
    compared: set[int] = set()
    first: dict[tuple[str, str], int] = {}
    newest: set[tuple[str, str]] = set()
    for key, run_id, question, bounds, state, word, name, threshold in reader.execute(of):
        verdict = judged(state, word)
        found[key].append(Edge(run_id, name, question or "", verdict, UNSTORED, threshold, bounds=bounds or ""))
        first.setdefault((key, name), run_id)
        if verdict == VerdictWord.VIOLATED or (verdict is not None and (key, name) not in newest):
            compared.add(run_id)
        if verdict is not None:
            newest.add((key, name))
    compared |= {run_id for of, run_id in first.items() if of not in newest}
    known = {edge.run_id: edge for edge in against.as_edges(of_runs(reader, compared))}
    return {key: [known.get(e.run_id, e) for e in edges] for key, edges in found.items()}


def _shown(now: Standing, edges: Sequence[Edge], most: int) -> list[int]:
    """The runs of a row that are read in full: those that count, then the newest others."""
    count = now.evidence | now.violations
    others = [e.run_id for e in edges if e.run_id not in count][:most]
    return sorted(count, reverse=True) + others


def _known(reader: sa.Connection, run_ids: Collection[int], now: present.Present) -> dict[int, Known]:
    known: dict[int, Known] = {}
    for some in chunks(run_ids):
        signed = signatures(reader, some, now)
        evidence = Run.summary["provenance"][EVIDENCE].as_string().label("evidence")
        of = sa.select(Run.id, CampaignRow.name, CampaignRow.document, evidence, *identity.COLUMNS)
        of = of.join(CampaignRow, CampaignRow.digest == Run.campaign_digest).where(Run.id.in_(some))
        stored = {row.id: row for row in reader.execute(of)}
        swept = set(reader.scalars(sa.select(Run.id).where(Run.id.in_(some), in_sweep())))
        for outcome in outcomes(reader, [Run.id.in_(some)]):
            run_id = run_number(outcome.id) or 0
            row = stored[run_id]
            name = "" if run_id in swept else row.name  # no variant is compared with the campaign it was made from
            changed = tuple(present.changes(now, run_id, name, row.document, identity.of_row(row)))
            own = signed.get(run_id, UNSIGNED)
            found = [one for one in own.signatures if one.row.withdrawn is None]
            known[run_id] = Known(outcome, found, own.not_carried, changed, row.evidence)
    return known


def _whole(edge: Edge, known: Known | None, key: str, worded: Texts) -> Edge:
    """The edge with sign-offs and changes, if its run is one that may count."""
    if known is None:
        return edge
    current = known.current
    reasons = [tuple(one.reasons(key)) for one in current]
    changes = reasons[-1] if reasons else (*known.changes, *worded.changes(edge.run_id, key))
    if () in reasons:
        changes = ()
    valid = [one for one, found in zip(current, reasons, strict=True) if not found] or current
    sources = {one.row.run_id for one in valid}
    return replace(
        edge,
        not_sampled=known.outcome.not_sampled,
        earlier_rules=known.outcome.earlier_rules,
        policy=known.outcome.policy,
        signed=bool(current),
        repeats=max(sources) if sources and edge.run_id not in sources else None,
        own=all(one.own for one in valid),
        not_carried=known.not_carried,
        changes=changes,
    )


def _role(edge: Edge, now: Standing) -> str:
    if edge.run_id not in now.violations:
        return "" if edge.run_id in now.evidence else "does not count"
    if edge.run_id in now.closer:
        return f"{CLOSER} of the newest"
    found = edge.verdict == VerdictWord.VIOLATED
    return "still violates" if found else "found a value at or below the newest threshold"


def _run(edge: Edge, known: Known, now: Standing, key: str) -> RequirementRun:
    violates, counts = edge.run_id in now.violations, edge.run_id in now.evidence
    return RequirementRun(
        **dict(known.outcome),
        part="violation" if violates else "evidence" if counts else "other",
        role=_role(edge, now),
        signoffs=[one.signoff(key) for one in known.signatures],
        signed=edge.signed,
        suspect=edge.signed and bool(edge.changes),
        changes=list(edge.changes),
        evidence_digest=known.evidence,
    )
