"""The bill of materials of a release, and what counts as an answer about advisories."""

from __future__ import annotations

import json
from pathlib import Path

from tools import advisories, sbom

LOCK = Path(sbom.ROOT) / "requirements.lock"


def test_every_locked_package_is_in_a_valid_document() -> None:
    text = LOCK.read_text(encoding="utf-8")
    names = [line.partition("==")[0] for line in text.splitlines() if line[:1].isalnum()]
    document = json.loads(sbom.python(text))
    assert document["specVersion"] == "1.5"
    assert {one["name"] for one in document["components"]} == {name.partition("[")[0] for name in names}
    assert sbom.wrong(json.dumps(document)) is None
    licensed = [one for one in document["components"] if one.get("licenses")]
    assert len(licensed) > 0.6 * len(names)
    numpy = next(one for one in document["components"] if one["name"] == "numpy")
    assert numpy["purl"] == f"pkg:pypi/numpy@{numpy['version']}"


def test_a_document_that_is_not_valid_is_refused() -> None:
    assert sbom.wrong('{"bomFormat": "CycloneDX", "specVersion": "1.5", "components": [{"type": "x"}]}') is not None


def test_what_was_not_asked_is_not_called_free_of_advisories() -> None:
    known = {"name": "a", "version": "1", "vulns": []}
    bad = {"name": "b", "version": "2", "vulns": [{"id": "PYSEC-1"}]}
    skipped = {"name": "c", "skip_reason": "Dependency not found on PyPI"}

    def pip(*found: object) -> advisories.Asked:
        return advisories.of_pip(json.dumps({"dependencies": found}), "")

    assert pip(known) == ([], 1, "")
    assert pip(known, bad) == (["b 2: PYSEC-1"], 2, "")
    assert pip(known, skipped).not_reached == "1 of 2 skipped; Dependency not found on PyPI"
    assert pip().not_reached == "nothing was audited"
    assert advisories.of_pip("", "ConnectionError: no route").not_reached == "ConnectionError: no route"
    refused = advisories.of_npm('{"message": "405"}', "npm warn x\nnpm error audit endpoint returned an error\n")
    assert refused.not_reached == "npm error audit endpoint returned an error"
    answer = {"vulnerabilities": {"x": {"severity": "high"}}, "metadata": {"dependencies": {"total": 9}}}
    assert advisories.of_npm(json.dumps(answer), "") == (["x: high"], 9, "")
