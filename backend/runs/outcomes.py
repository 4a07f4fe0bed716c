"""What came out of runs, as compared over time: verdict, worst margin, probability bound, code. Read `outcomes`.

The list of runs shows the best value of a search that still runs; an outcome has numbers only of a run that is done.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sqlalchemy as sa

from backend.db.tables import CampaignRow, Run
from backend.http.schema import Instant, Schema
from backend.runs import earlier_rules, identity, policy, quantities, sample_kind, violations
from backend.runs.sample_kind import BoundSource
from campaigns.claims.lowest_value import unconfirmed
from campaigns.claims.spans import words
from campaigns.results.regression import PolicyWord
from campaigns.results.verdict import VerdictWord
from campaigns.runs import RunState, run_name


class Outcome(Schema):
    """The outcome of a run. Times are seconds since 1970; costs and margins are in `unit`.

    Numbers are null unless the run is done: those of a cancelled or failed run would be of an incomplete search. A
    lowest value at or below the threshold is stated all the same: `unconfirmed`.
    """

    id: str
    """R-0001"""
    name: str
    state: RunState
    verdict: VerdictWord | None
    error: str | None
    campaign_name: str
    campaign_digest: str
    seed: int | None
    """Null if this version cannot read it in the stored campaign."""
    code: str | None
    """Digest of its identity: engine, own files, packages; None before its first stage, or if something of it is not
    identified."""
    unidentified: list[str]
    """What of its identity was not stored or cannot be read exactly."""
    clearance: str | None
    """Version of Clearance that ran it."""
    quantity: str
    unit: str
    threshold: float | None
    worst_cost: float | None
    margin: float | None
    """Worst value minus threshold; 0 or less violates the criterion."""
    upper_bound: float | None
    """Upper bound on P(violation), from the sample that `bound_source` names; null without one."""
    bound_source: BoundSource | None = None
    """`certify`: the independent sample of the certify stage. `certify_stated`: the same with a stated seed, which
    a user may have chosen. `search`: there is no certify stage, and the sample is a random search with the seed of
    the campaign. Nothing is cleared by the last two. Null without a bound."""
    excluded_samples: int | None = None
    """Draws of that sample that were excluded, of which the bound says nothing, or which it counts as no violations;
    null without a bound, and in results of earlier versions."""
    excluded_fraction: float | None = None
    """Of all draws of that sample."""
    violations: int | None
    failed_samples: int | None
    """Of the violations: samples without a value, because their evaluation failed."""
    samples: int | None
    confidence: float | None
    """Of the upper bound."""
    not_sampled: bool = False
    """Whether nothing but an independent sample is missing to clear it."""
    earlier_rules: bool = False
    """Whether it is cleared by the rules of an earlier version, and `clearance audit` names what does not hold by those
    of today."""
    against: str = ""
    """As of the run: which others speak against its verdict, a sentence; empty if none does."""
    policy: PolicyWord | None = None
    """What the campaign's policy says of the changes since the baseline: `holds`; `fails`, which is exit code 1
    whatever the verdict; `accepts`, a violated run whose violations were all known. Null without a comparison."""
    unconfirmed: str = ""
    """Of a cancelled or failed run: the sentence on its lowest value, where that is at or below the threshold and thus
    speaks against a requirement without a verdict; empty otherwise."""
    created: Instant
    finished: Instant | None
    removed: bool
    """Whether it is removed from the lists."""


_PLAIN = ("name", "state", "verdict", "error", "campaign_digest", "threshold", "created", "finished")
_NUMBERS = ("worst_cost", "upper_bound", "violations", "failed_samples", "samples", "confidence")
_STATISTICS = {
    "violations": Run.summary["statistics", "violations"].as_integer(),
    "failed_samples": Run.summary["statistics", "failed"].as_integer(),
    "confidence": Run.summary["statistics", "confidence"].as_float(),
}


def outcomes(
    reader: sa.Connection, conditions: Sequence[sa.ColumnElement[bool]], limit: int | None = None
) -> list[Outcome]:
    """The outcomes of the runs that fulfil the conditions, newest first; purged runs are omitted."""
    columns = [Run.id, Run.removed, Run.worst_cost, Run.upper_bound, *(getattr(Run, name) for name in _PLAIN)]
    columns += [expression.label(name) for name, expression in _STATISTICS.items()]
    columns += [*quantities.COLUMNS, *sample_kind.COLUMNS, *policy.COLUMNS, *identity.COLUMNS]
    columns += [earlier_rules.COLUMN]
    columns += [Run.flown["clearance"].as_string().label("clearance")]
    columns += [CampaignRow.name.label("campaign_name"), CampaignRow.document["seed"].as_string().label("seed")]
    query = sa.select(*columns).join(CampaignRow, CampaignRow.digest == Run.campaign_digest)
    query = query.where(Run.purged.is_(None), *conditions).order_by(Run.id.desc()).limit(limit)
    rows = reader.execute(query).all()
    described = quantities.installed(reader, rows)
    against = violations.sentences(reader, [row.id for row in rows])
    return [_outcome(row, quantities.of(row, described), against.get(row.id, "")) for row in rows]


def _outcome(row: Any, measured: quantities.Measured, against: str) -> Outcome:
    done = row.state == RunState.DONE
    values = {name: getattr(row, name) for name in _PLAIN}
    values |= {name: getattr(row, name) if done else None for name in _NUMBERS}
    known = values["worst_cost"] is not None and row.threshold is not None
    own, sample = identity.of_row(row), sample_kind.of(row)
    return Outcome(
        **values,
        id=run_name(row.id),
        margin=values["worst_cost"] - row.threshold if known else None,
        bound_source=sample.bound_source if done else None,
        excluded_samples=sample.excluded_samples if done else None,
        excluded_fraction=sample.excluded_fraction if done else None,
        quantity=measured.quantity,
        unit=measured.unit,
        code=None if own is None else own.digest,
        unidentified=[] if own is None else list(own.unidentified),
        clearance=row.clearance,
        not_sampled=sample.not_sampled,
        earlier_rules=earlier_rules.of(row),
        against=against,
        policy=policy.of(row),
        unconfirmed=words(unconfirmed(row.state, row.worst_cost, row.threshold, measured.unit)),
        campaign_name=row.campaign_name,
        seed=_seed(row.seed),
        removed=row.removed is not None,
    )


def _seed(text: str | None) -> int | None:
    """The seed of a stored campaign; without one it is 1."""
    try:
        return 1 if text is None else int(text)
    except ValueError:  # of another version, or damaged
        return None
