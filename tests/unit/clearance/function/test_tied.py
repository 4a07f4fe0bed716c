"""Functions whose lowest value is at many points: who found which of them, and who found it first, is told apart."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

import clearance
from tests.audited import audited

RANGES = {"a": (0.0, 1.0), "b": (0.0, 1.0)}
BOXES = {"first": np.array([0.15, 0.2]), "second": np.array([0.85, 0.7])}
LOWEST = 3.0


def stepped(a: float, b: float) -> float:
    """One box of the lowest value, in which each side of `auto` has a point of its own; the witness comes first."""
    return LOWEST if a > 0.94 and b < 0.1 else 5.0 - 0.1 * round(3 * a)


def boxes(a: float, b: float) -> float:
    """Two boxes of the lowest value, with a ridge between them."""
    away = min(float(np.abs(np.array([a, b]) - place).max()) for place in BOXES.values())
    return max(LOWEST, LOWEST + 8 * (away - 0.06))


def nearest(point: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> str:
    return min(BOXES, key=lambda name: float(np.abs(point - BOXES[name]).max()))


def test_a_run_in_which_both_sides_reach_one_value_is_audited(tmp_path: Path) -> None:
    found = clearance.search(stepped, RANGES, 1.0, methods={"auto": 900}, certify=60, validation=4000, seed=0)
    found.save(tmp_path / "out")
    (search,) = (one for one in json.loads((tmp_path / "out/evidence.json").read_text())["results"] if "members" in one)
    sharing, witness = search["apart"]
    assert (sharing["best"], witness["best"]) == (LOWEST, LOWEST)
    assert witness["index"] < sharing["index"]
    assert search["family"] == witness["family"]
    audited(tmp_path / "out")


def test_what_a_search_found_is_in_the_basin_of_the_finding_that_it_is_said_of(tmp_path: Path) -> None:
    found = clearance.search(
        boxes, RANGES, 1.0, methods={"auto": 400, "direct": 200}, certify=60, validation=3000, seed=0
    )
    folder = tmp_path / "out"
    found.save(folder)
    audited(folder)
    evidence, result = (json.loads((folder / f"{name}.json").read_text()) for name in ("evidence", "result"))
    with np.load(folder / "evaluations.npz") as stored:
        points = {k: stored[f"points_{k}"] for k in range(len(evidence["results"]))}
    box = {f["label"]: nearest(np.array(f["point"])) for f in result["findings"]}
    assert sorted(box.values()) == sorted(BOXES), "each box is one finding"
    for finding in result["findings"]:
        for by in finding["found"]:
            assert nearest(points[by["position"]][by["evaluations"] - 1]) == box[finding["label"]]
    for row in result["comparison"]:
        search = evidence["results"][row["position"]]
        ends = [(row["basin"], search["best"]["index"])]
        ends += zip(row.get("apart") or [], (part["index"] for part in search.get("apart") or []), strict=True)
        for label, index in ends:
            assert label is None or nearest(points[row["position"]][index]) == box[label]
