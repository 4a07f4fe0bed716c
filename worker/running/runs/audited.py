"""The audit of a stored run with what this installation knows of it: `audited`."""

from __future__ import annotations

from campaigns.checked.snapshot import changes
from campaigns.versions import Versions
from worker.evidence.audit import judge
from worker.evidence.audit.estimate import UNKNOWN, Searched
from worker.evidence.audit.judge import Item, Known
from worker.evidence.audit.record import MALFORMED, MISSING, Missing, Record
from worker.evidence.restatement.names import beyond
from worker.evidence.restatement.restate import restated, titles
from worker.running.catalogue.installed import catalogue
from worker.running.runs import identity
from worker.running.runs.estimates import repeated


def audited(record: Record) -> list[Item]:
    """Every claim of the record with its recomputed value; nothing is evaluated."""
    try:
        found = known(record)
    except MALFORMED as error:
        raise judge.no_run(error) from None
    return judge.audit(record, found)


def known(record: Record) -> Known:
    """The sentences of the record made again, and its components next to those that are installed."""
    searches: dict[int, Searched | Missing | None] = {**repeated(record)}
    today = identity.code(record.campaign).digest
    if _code(record) not in (None, today):
        searches = {k: UNKNOWN if found is None else found for k, found in searches.items()}
    return Known(restated(record), titles(record), _components(record, today), searches, beyond(record))


def _components(record: Record, today: str) -> list[str] | Missing:
    """How the descriptions in the record differ from those here, if the code is today's; texts may have changed."""
    claims = record.claims
    if "components" not in claims or _code(record) is None:
        return Missing(MISSING)
    if _code(record) != today:
        return Missing("other code ran it: what its components meant there is taken from the record")
    found = [clause for clause in changes(claims["components"], catalogue()) if not clause.startswith("the text of ")]
    gone = [clause for clause in found if clause.endswith(" is not in this installation")]
    return Missing("; ".join(gone)) if gone else found


def _code(record: Record) -> str | None:
    """The digest of the code that ran it; None: not stored by its version."""
    claims = record.claims
    return Versions.of(claims["versions"] if "versions" in claims else claims.get("provenance")).code
