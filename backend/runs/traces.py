"""Why a run of a simulator has no trace, in words: for its page and its report. Read `no_trace`."""

from __future__ import annotations

from collections.abc import Mapping

import sqlalchemy as sa

from backend.db.tables import Stage, Trace

NOMINAL = "nominal"
VALUES = "only the values of its results can be shown"


def no_trace(reader: sa.Connection, run_id: int) -> str:
    """The sentences for a run without any trace; empty if one is stored."""
    if reader.scalar(sa.select(Trace.name).where(Trace.run_id == run_id).limit(1)) is not None:
        return ""
    columns = [Stage.result["untraced"].label("untraced"), Stage.result["cost"].label("cost")]
    found = reader.execute(sa.select(*columns).where(Stage.run_id == run_id).order_by(Stage.position)).all()
    reasons = {name: reason for stage in found for name, reason in (stage.untraced or {}).items()}
    # The first stage asks for the trace of the nominal case, if that has a value.
    return _sentences(reasons, bool(found) and found[0].cost is not None)


def _sentences(reasons: Mapping[str, str], tried: bool) -> str:
    """State why there is none.

    reasons: why a case has none, by its name: there are some only if the simulator declares a trace. tried: whether
    the trace of a case was asked for, which without a reason means that it declares none.
    """
    if not reasons:
        stored = "This simulator declares no trace" if tried else "No trace is stored"
        return f"{stored}: {VALUES}."
    cases: dict[str, list[str]] = {}
    for name, reason in reasons.items():
        cases.setdefault(reason, []).append("the nominal case" if name == NOMINAL else name)
    each = [f"No trace of {', '.join(names)}: {reason.rstrip('.')}." for reason, names in cases.items()]
    return " ".join([f"This simulator declares a trace, but returned none that could be stored: {VALUES}.", *each])
