"""The rules of a claim: each is written once, in order; the audit has the limits again."""

from __future__ import annotations

import ast
from pathlib import Path
from typing import get_args

from campaigns import rules
from campaigns.codes import CheckCode
from campaigns.results import remedies
from campaigns.results.base import MethodKind
from campaigns.rules import FAMILIES, LIMITS, RULES
from campaigns.stages import nominal
from campaigns.stages.found import declared
from worker.engine.stages.parts import scales
from worker.evidence.audit import limits as audit

ALL_CHECKS = True
"""The limits as they are."""
REPOSITORY = Path(__file__).parents[3]
PLACES = (
    *("worker/evidence/verdicts", "worker/engine/stages"),
    *("campaigns/checked", "campaigns/claims", "campaigns/results", "backend/reports"),
)
"""Where a limit could be written a second time."""

OTHERS: dict[str, set[float]] = {
    # Lengths and margins of drawings, the status of an answer, and the length of a cursor.
    "backend/reports/charts.py": {0.1},
    "backend/reports/endpoints.py": {200, 1000},
    "backend/reports/figures.py": {10.0, 200},
    "backend/reports/plan_view.py": {0.05},
    "backend/reports/plot.py": {0.05, 1e-6, 10.0},
    # Milliseconds in a second and a least budget; the lowest flights that are kept of a counted sample.
    "campaigns/results/remedies.py": {1000},
    "campaigns/results/sample.py": {1000},
    # A power of ten.
    "campaigns/checked/extents.py": {10.0},
    # A time that is shown as less than 0.1 s, a slack of decimals; examples of numbers.
    "campaigns/claims/numbers.py": {0.05, 0.01},
    # Times [s], and the shortest that a rate is computed from.
    "worker/engine/stages/parts/driver.py": {0.2, 1e-6},
    "worker/engine/stages/parts/in_slots.py": {0.2},
    "worker/engine/stages/parts/slot_driver.py": {1e-6},
    # Distances among candidates, as fractions of every range.
    "worker/engine/stages/parts/counting.py": {1e-6},
    "worker/engine/stages/parts/candidates.py": {0.03, 0.1},
    # Fractions of nominal minus worst between which a gap is.
    "worker/engine/stages/parts/scales.py": {0.1, 0.9},
    # The exponent of the index of a random stream.
    "worker/engine/stages/estimate.py": {25},
}
"""Numbers that are equal to a limit and mean something else, by file."""


def numbers(path: Path) -> set[float]:
    """Those in a file that are equal to a limit; small whole numbers and 100 mean too much else, and 1e-9 guards a
    rounding."""
    limits = [limit.value for limit in LIMITS.values() if limit not in (rules.AGREEMENT_ROUNDING, rules.REALISATIONS)]
    known = {(type(n), n) for n in limits if isinstance(n, float) or n >= 25}
    constants = [n.value for n in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(n, ast.Constant)]
    return {n for n in constants if (type(n), n) in known}


def test_no_limit_is_written_a_second_time() -> None:
    files = [path for place in PLACES for path in (REPOSITORY / place).rglob("*.py")]
    found = {str(path.relative_to(REPOSITORY)): numbers(path) for path in files}
    assert {path: n for path, n in found.items() if n} == OTHERS


def test_every_check_has_one_rule_in_order() -> None:
    assert [rule.code for rule in RULES] == list(CheckCode)
    assert [rules.position(code) for code in CheckCode] == list(range(len(RULES)))
    assert rules.rule("half step") is None
    assert rules.position("half step") == len(RULES)


def test_what_a_rule_names_exists() -> None:
    assert {kind for rule in RULES for kind in rule.evidence} <= declared().keys()
    assert {rule.remedy for rule in RULES if rule.remedy} == remedies._OF.keys()
    assert FAMILIES.keys() == set(get_args(MethodKind))


def test_the_audit_has_the_same_limits() -> None:
    others = (
        "LEAST",
        "ORDER",
        "OF_VIOLATIONS",
        "BASELINES",
        "BESIDE",
        "ROUNDED",
        "TAILS",
        "LOWEST",
        "SHARED",
        "CALLED",
        "AFTER",
        "VIOLATING",
        "WHOLE",
        "BASINS",
        "HALVED",
        "WIDER",
        "ALIKE",
        "MEASURED",
        "GRANTED",
        "NEAREST",
        "EACH",
        "PARTS",
        "CARRIED",
        "BUILT",
        "CLEARING",
        "BOTTOM",
        "TOP",
        "MANY",
        "RULES",
        "SMALLEST",
        "POINTS",
        "TIMES",
    )  # from BASELINES to RULES they are numbers of a version
    mine = {name: value for name, value in vars(audit).items() if name.isupper() and name not in others}
    assert mine == {name: LIMITS[name].value for name in mine}
    assert (scales.LOW, scales.HIGH, scales.FEW) == (audit.BOTTOM, audit.TOP, audit.MANY)
    assert (nominal.POINTS, nominal.TIMES) == (audit.POINTS, audit.TIMES)
    assert {kind: family.least.value for kind, family in FAMILIES.items() if family.least} == audit.LEAST
    assert tuple(rule.code for rule in RULES) == audit.ORDER
    assert tuple(rule.code for rule in RULES if rule.of_violations) == audit.OF_VIOLATIONS


def test_other_guides_state_todays_limits() -> None:
    methods, first = ((REPOSITORY / "docs" / name).read_text() for name in ("methods.md", "first-campaign.md"))
    least = f"needs at least {rules.GLOBAL_LEAST.value} evaluations per parameter to count as a search"
    assert least in " ".join(methods.split())
    stated = f"agreement: {rules.AGREEMENT.value:g} "
    assert [line for line in first.splitlines() if line.startswith(stated)] == [
        f"{stated:<41}# fraction of nominal minus worst within which the methods agree; "
        f"at most {rules.AGREEMENT_AT_MOST.value:g},"
    ]
