"""The argument in Goal Structuring Notation: only what stands supports a goal, and everything else shows."""

from __future__ import annotations

import hashlib
import os
import subprocess
from pathlib import Path
from typing import Any

import pytest
import yaml

from backend.requirements.gsn import argument
from backend.requirements.schemas import RequirementRow, RequirementRun
from backend.signoffs.schemas import Signoff

GSN2X = os.environ.get("CLEARANCE_GSN2X", "")
"""The program gsn2x 4, if it is installed."""
LEADS = ("supportedBy", "inContextOf")


SIGNED = Signoff(
    id=1, run="R-0001", name="Ada: #1", typed=True, stated=None, role="Lead", comment="", digest="d" * 64, current=True,
    standing="standing", reasons=[], repeated_by=None, sentence="of these results", account="local", user="local",
    own=False, created=3.0, withdrawn=None, withdrawn_by=None, withdrawn_reason=None,
)  # fmt: skip


def run(number: int, verdict: str | None = "cleared", **changes: Any) -> RequirementRun:
    known: dict[str, Any] = {
        "id": f"R-{number:04d}", "name": "x", "state": "done" if verdict else "failed", "verdict": verdict,
        "error": None,
        "campaign_name": f"Campaign {number}", "campaign_digest": f"{number:x}" * 64, "seed": 1, "code": "c" * 64,
        "unidentified": [],
        "clearance": "0.1.0", "quantity": "d_min", "unit": "m", "threshold": 0.5, "worst_cost": 0.84, "margin": 0.34,
        "upper_bound": None, "violations": None, "failed_samples": None, "samples": None, "confidence": None,
        "created": 1.0, "finished": 2.0, "removed": False, "part": "evidence", "role": "",
        "signed": True, "suspect": False, "changes": [],
        "signoffs": [SIGNED], "evidence_digest": None,
    }  # fmt: skip
    return RequirementRun(**(known | changes))


def row(key: str, status: Any, *runs: RequirementRun, text: str = "Keep clear") -> RequirementRow:
    return RequirementRow(
        id=key, text=text, status=status, sentence="Because.", registered=True, file=None, attributes={}, changed=None,
        changed_by=None, etag="", runs=list(runs), total=len(runs), unlisted=0, removed=0, sweeps=0,
    )  # fmt: skip


UNSIGNED: dict[str, Any] = {"signed": False, "signoffs": []}
CHANGE = "the code has changed (sha256 aa, now bb)"
SUSPECT: dict[str, Any] = {"suspect": True, "changes": [CHANGE]}
ROWS = [
    row("MET", "met", run(1), run(2)),
    row("UN SIGNED", "unsigned", run(1), run(3, **UNSIGNED)),
    row("UN_SIGNED", "suspect", run(4, **SUSPECT)),
    row(
        "BAD: [x]",
        "violated",
        run(5, "violated", part="violation"),
        run(6),
        text='Keep "0.5 m": {always} # now\nsecond',
    ),
    row("OPEN", "inconclusive", run(7, "inconclusive")),
    row("FAILED", "no verdict", run(8, None, margin=None, **UNSIGNED)),
    row("LUCKY", "not sampled", run(9, not_sampled=True)),
    row("NONE", "no evidence", text=""),
    row("7", "no evidence"),
    row("all-requirements", "no evidence"),
    row("requirements", "no evidence"),
    row(f"UN_SIGNED_{hashlib.sha256(b'UN SIGNED').hexdigest()[:8]}", "no evidence", text="named to hide another"),
]


def made(*rows: RequirementRow) -> Any:
    claims = {"R-0001": "Cleared: d_min stays above 0.5 m."}
    return yaml.safe_load(argument(rows, claims, "https://c.example", 0.0, "c" * 64))


def beneath(nodes: Any, name: str) -> set[str]:
    found = {name}
    for child in nodes[name].get("supportedBy", []):
        found |= beneath(nodes, child)
    return found


def test_a_requirement_is_supported_throughout_only_if_it_is_met() -> None:
    nodes = made(*ROWS)
    for goal, given in zip(nodes["S-all-requirements"]["supportedBy"], ROWS, strict=True):
        open_goals = {name for name in beneath(nodes, goal) if nodes[name].get("undeveloped")}
        assert nodes[goal]["text"].startswith(given.id)
        assert bool(open_goals) == (given.status != "met"), given.id
        assert nodes[goal]["status"] == given.status
    assert {name for name in nodes if name.startswith("Sn-")} == {
        "Sn-MET-R-0001", "Sn-MET-R-0002", next(n for n in nodes if n.startswith("Sn-UN_SIGNED_")),
    }  # fmt: skip


def test_a_violation_defeats_its_requirement_which_nothing_supports() -> None:
    nodes = made(*ROWS)
    (counter,) = [name for name in nodes if name.startswith("CSn-")]
    goal = nodes[nodes[counter]["challenges"]]
    assert (goal["defeated"], goal["undeveloped"], "supportedBy" in goal) == (True, True, False)
    assert goal["text"] == 'BAD: [x]: Keep "0.5 m": {always} # now\nsecond'
    assert nodes[counter]["text"].startswith("R-0005 is violated")
    assert nodes[goal["inContextOf"][0]]["text"].startswith("R-0006 is cleared")


def test_a_campaign_of_which_only_a_run_against_it_is_known_is_a_goal_of_its_own() -> None:
    """Cancelled after it found a value: no other run of its campaign counts."""
    lost = run(2, None, part="violation", role="found a value at or below the newest threshold", **UNSIGNED)
    cleared = run(3, part="violation", campaign_name="Campaign 2", threshold=0.4)
    for other in (lost, cleared):
        nodes = made(row("HALF", "inconclusive", other, run(1)), row("LOST", "inconclusive", other))
        for name in ("HALF", "LOST"):
            open_goals = {goal for goal in beneath(nodes, f"G-{name}") if nodes[goal].get("undeveloped")}
            assert open_goals == {f"G-{name}-{other.id}"}
            assert nodes[f"G-{name}-{other.id}"]["inContextOf"] == [f"C-{name}-{other.id}"]
        assert "Sn-HALF-R-0001" in nodes


def test_every_leaf_has_claim_digest_and_link_and_shows_what_is_suspect() -> None:
    nodes = made(*ROWS)
    leaves = {
        name: node for name, node in nodes.items() if name.startswith(("Sn-", "CSn-", "C-")) and name != "C-export"
    }
    assert len(leaves) == 10
    for node in leaves.values():
        assert {"text", "claim", "digest", "url"} <= node.keys()
        assert node["digest"].startswith("sha256 ")
    solution = nodes["Sn-MET-R-0001"]
    assert solution["claim"] == "Cleared: d_min stays above 0.5 m."
    assert solution["url"] == "https://c.example/runs/R-0001"
    assert "Ada: #1 (Lead" in solution["text"]
    assert nodes["C-UN_SIGNED-R-0004"]["text"].endswith(f". SUSPECT: {CHANGE}")


def test_the_document_is_a_tree_that_starts_at_one_goal() -> None:
    for nodes in (made(*ROWS), made()):
        pointed = [name for node in nodes.values() for key in LEADS for name in node.get(key, [])]
        assert set(pointed) <= nodes.keys()
        assert len(pointed) == len(set(pointed))
        roots = nodes.keys() - set(pointed)
        assert {name for name in roots if not name.startswith("CSn-")} == {"G-all-requirements"}
        for name, node in nodes.items():
            assert isinstance(name, str)
            if name.startswith(("G-", "S-")):
                assert ("supportedBy" in node) != bool(node.get("undeveloped")), name


@pytest.mark.skipif(not GSN2X, reason="CLEARANCE_GSN2X names no program")
def test_gsn2x_accepts_it(tmp_path: Path) -> None:
    for i, rows in enumerate((ROWS, [])):
        file = tmp_path / f"{i}.gsn.yaml"
        file.write_text(argument(rows, {}, "https://c.example", 0.0, None), encoding="utf-8")
        done = subprocess.run([GSN2X, "--check", file.name], cwd=tmp_path, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr) == (0, "")
