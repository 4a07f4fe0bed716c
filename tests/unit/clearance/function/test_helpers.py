"""Two versions of a helper in another folder are told apart wherever a search states what evaluated it."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

import clearance
from clearance.cli import invoke

pytestmark = pytest.mark.nightly


def test_a_search_names_the_version_of_what_its_function_imports(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / "lowered_far.py").write_text("SHIFT = 0.0\n", encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path / "elsewhere")
    import lowered_far  # type: ignore[import-not-found]

    def dip(a: float) -> float:
        return 2.0 - a * a - float(lowered_far.SHIFT)

    stated = []
    for shift in (0.0, 0.5, 0.0):
        monkeypatch.setattr(lowered_far, "SHIFT", shift)
        result = clearance.search(dip, {"a": (-0.5, 0.5)}, 1.0, methods={"direct": 20}, certify=0)
        out = result.save(tmp_path / f"out-{shift}")
        assert invoke(["audit", str(out)]) == 0
        identity = json.loads((out / "result.json").read_text(encoding="utf-8"))["identity"]
        digest = identity["files"]["simulators/dip"]
        assert f"function digest {digest[:12]}." in result.verdict.scope
        page = result.report(tmp_path / "report.html").read_text(encoding="utf-8")
        assert digest in page
        stated.append((digest, identity["digest"]))
    assert stated[0] == stated[2]
    assert not {*stated[0]} & {*stated[1]}
    del sys.modules["lowered_far"]
