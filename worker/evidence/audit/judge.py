"""The audit: compares every claim of a record with its evaluations, and the verdict with the rules.

Start reading at `audit`; `closing` is the final sentence.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from campaigns.claims.spans import Spans
from campaigns.refusals import RefusalCode
from worker.evidence.audit import limits
from worker.evidence.audit.checks import as_stated, in_order
from worker.evidence.audit.estimate import Searched
from worker.evidence.audit.parts import written
from worker.evidence.audit.points import required
from worker.evidence.audit.recompute import Run
from worker.evidence.audit.record import MALFORMED, MISSING, Missing, Record, UnreadableError
from worker.evidence.audit.results import of_results
from worker.evidence.audit.sentences import shown, unlike
from worker.evidence.audit.statement import compared_sentence
from worker.evidence.audit.stored import of_evaluations
from worker.evidence.audit.today import resting

EARLIER = "earlier rules."
"""Before the names of claims that hold by the rules of the record's version alone."""
ABSENT = "absent"
"""In place of a value that every run of this version stores."""


def no_run(error: Exception) -> UnreadableError:
    """The refusal of a record of another form."""
    message = f"the record is not that of a run: {type(error).__name__}: {error}"
    return UnreadableError(message, RefusalCode.UNREADABLE)


class Item(NamedTuple):
    """One claim: its path in the record, the value given there, and the recomputed one."""

    name: str
    given: Any
    recomputed: Any

    @property
    def agrees(self) -> bool | None:
        """Whether stored and recomputed values agree; None if one of the two is unknown."""
        if isinstance(self.given, Missing) or isinstance(self.recomputed, Missing):
            return None
        if isinstance(self.given, int | float) and isinstance(self.recomputed, int | float):
            return math.isclose(self.given, self.recomputed, rel_tol=1e-9, abs_tol=1e-15)
        return bool(self.given == self.recomputed)


class Known(NamedTuple):
    """What is known of a run besides its record. sentences: as stored and as made again, by path; titles: how checks
    are shown, likewise; components: how those that its record describes differ from the same ones here, as clauses; or
    why there is nothing to compare. searches: of estimates, by stage; None if its stored evaluations are not those that
    it requests. names: paths of what no record of this version has."""

    sentences: Mapping[str, tuple[Any, Spans | Missing]] | Missing
    titles: Mapping[str, tuple[Any, Any]]
    components: list[str] | Missing
    searches: Mapping[int, Searched | Missing | None] = {}
    names: list[str] | Missing = Missing("not compared")


NOTHING = Known(Missing("not made again"), {}, Missing("not compared"))


def audit(
    record: Record, known: Known = NOTHING, at_most: int = limits.VIOLATIONS, spot_checks: int = limits.SPOT_CHECKS
) -> list[Item]:
    """Every claim with its recomputed value; raises `UnreadableError` for a record with a different structure."""
    try:
        run = Run(record)
        run.searched = known.searches
        claims = run.claims | {"sound": True, "placed": True, "possible": True, "checks": as_stated(run)}
        try:
            run.describe()
            claims["sentence"], sentence = _apart(compared_sentence(run))
            follows = [*of_evaluations(run), ("sentence", sentence), *of_results(run, at_most, spot_checks)]
            expected = written(dict(follows))
            claims["points"], expected["points"] = _apart(required(run))
            if run.sealed and not run.reworded:
                claims["order of checks"], expected["order of checks"] = in_order(run)
            if run.sealed:
                claims["checks"] = dict.fromkeys(expected["checks"], ABSENT) | claims["checks"]
        except (KeyError, TypeError):  # with a result or the catalogue absent or null, only a violation follows
            unknown = dict.fromkeys(("results", "comparison", "statistics", "sentence"), MISSING)
            expected = written(dict(of_evaluations(run))) | unknown
            expected["checks"] = dict.fromkeys(claims["checks"], MISSING)
            if run.sealed:
                claims["whole"], expected["whole"] = "results or components are absent, or of another form", "whole"
        worded = [*_worded(run, known)] if run.sealed else [Item("words", MISSING, MISSING)]
        by = f"by the rules of version {run.wording}"
        rest = resting(run, record, known.searches, at_most, spot_checks) if "whole" not in expected else ()
        earlier = [Item(EARLIER + name, by, Missing("not by those of today")) for name in rest]
    except MALFORMED as error:
        raise no_run(error) from None
    twice = [Item(name, *pair) for name, pair in record.twice.items()]
    return [*twice, *_compared("", claims, expected, ABSENT if run.sealed else MISSING), *worded, *earlier]


def _apart(pairs: Mapping[str, tuple[object, object]]) -> Iterator[Mapping[str, object]]:
    """What is stated, and what is required, by name."""
    return ({name: pair[k] for name, pair in pairs.items()} for k in (0, 1))


def _worded(run: Run, known: Known) -> Iterator[Item]:
    """The sentences that were made again, texts that are not the words of their spans, and the components."""
    if isinstance(known.sentences, Missing):
        yield Item("words", known.sentences, MISSING)
    else:
        for path, (stored, made) in known.sentences.items():
            yield Item(f"words.{path}", *shown(stored, made))
    yield from (Item(f"words.checks.{path}.shown", *pair) for path, pair in known.titles.items())
    for path, stated, spans in unlike({k: v for k, v in run.claims.items() if isinstance(v, dict | list)}, run.written):
        yield Item(f"words.{path}", stated, spans)
    yield Item("components", [], known.components)
    if not run.reworded:
        yield Item("names", known.names, [])


def closing(items: Sequence[Item]) -> tuple[bool, str]:
    """Whether the verdict follows, and the sentence that states this."""
    wrong, unknown = ([item.name for item in items if item.agrees is flag] for flag in (False, None))
    left = f"; {len(unknown)} of {len(items)} items could not be audited" if unknown else ""
    if "words" in unknown:
        left += ", the sentences of the record among them: judge by its values"
    if wrong:
        return False, f"the verdict does not follow from what the run stored: {', '.join(wrong)} disagree{left}"
    earlier = [item for item in items if item.name.startswith(EARLIER)]
    if earlier:
        names = ", ".join(item.name.removeprefix(EARLIER) for item in earlier)
        by = f"it holds {earlier[0].given}, and not by those of today: {names}"
        return False, f"it is not known whether the verdict follows: {by}{left}"
    if "verdict" in unknown:
        return False, f"it is not known whether the verdict follows{left}"
    return True, f"the verdict follows from the stored evaluations{left}"


def _compared(name: str, stated: Any, expected: Any, absent: str) -> Iterator[Item]:
    if isinstance(expected, dict) and isinstance(stated, dict) and not name.endswith("at_bounds"):
        for key, value in expected.items():
            found = stated.get(key, absent if value is not None or isinstance(absent, Missing) else None)
            yield from _compared(f"{name}.{key}".lstrip("."), found, value, absent)
    elif isinstance(expected, list) and isinstance(stated, list):
        yield Item(f"{name}.count", len(stated), len(expected))
        for k, pair in enumerate(zip(stated, expected, strict=False)):
            yield from _compared(f"{name}.{k}", *pair, absent)
    elif isinstance(expected, tuple):  # a sentence
        yield Item(name, *shown(stated, expected))
    else:
        yield Item(name, stated, None if expected != expected else expected)  # NaN: there is no such cost
