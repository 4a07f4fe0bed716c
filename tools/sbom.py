"""Writes the bill of materials of a release, CycloneDX 1.5 as JSON: `make sbom`.

build/sbom/python.cdx.json lists requirements.lock, with the licences of what is installed; build/sbom/pages.cdx.json
lists frontend/package-lock.json, written by npm. Both are validated against the schema of CycloneDX.
"""

from __future__ import annotations

import importlib.metadata
import json
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from cyclonedx.contrib.license.factories import LicenseFactory
from cyclonedx.model import HashAlgorithm, HashType, Property
from cyclonedx.model.bom import Bom
from cyclonedx.model.component import Component, ComponentType
from cyclonedx.output.json import JsonV1Dot5
from cyclonedx.schema import SchemaVersion
from cyclonedx.validation.json import JsonStrictValidator
from packageurl import PackageURL

ROOT = Path(__file__).parents[1]
_LOCKED = re.compile(r"^([A-Za-z0-9._-]+)(?:\[[^]]*\])?==([^\s;\\]+)", re.MULTILINE)
_HASH = re.compile(r"--hash=sha256:([0-9a-f]{64})")


def locked(text: str) -> Iterator[tuple[str, str, list[str]]]:
    """Name, version and hashes of every entry of a lock file."""
    found = list(_LOCKED.finditer(text))
    ends = [match.start() for match in found[1:]] + [len(text)]
    for match, end in zip(found, ends, strict=True):
        yield match[1], match[2], _HASH.findall(text[match.end() : end])


def python(lock: str) -> str:
    """The document of the Python packages."""
    bom, licences = Bom(), LicenseFactory()
    root = Component(name="clearance", version=importlib.metadata.version("clearance"), type=ComponentType.APPLICATION)
    root.bom_ref.value = "clearance"
    bom.metadata.component = root
    components = []
    for name, version, hashes in locked(lock):
        licence = _licence(name, version)
        component = Component(
            name=name,
            version=version,
            bom_ref=f"{name}@{version}",
            purl=PackageURL("pypi", None, name.lower(), version),
            licenses=[licences.make_from_string(licence)] if licence else [],
            # of the one file where there is only one; of several, none is the hash of the component
            hashes=[HashType(alg=HashAlgorithm.SHA_256, content=hashes[0])] if len(hashes) == 1 else [],
            properties=[Property(name="clearance:files", value=str(len(hashes)))],
        )
        bom.components.add(component)
        components.append(component)
    bom.register_dependency(root, components)
    return str(JsonV1Dot5(bom).output_as_string(indent=2))


def _licence(name: str, version: str) -> str:
    """The licence that the installed package states; empty if another version or nothing is installed."""
    try:
        found = importlib.metadata.metadata(name)
    except importlib.metadata.PackageNotFoundError:
        return ""
    if found["Version"] != version:
        return ""
    stated = found.get("License-Expression") or found.get("License") or ""
    classified = [c.rpartition(" :: ")[2] for c in found.get_all("Classifier") or () if c.startswith("License :: ")]
    first = stated.strip().partition("\n")[0]
    return first if 0 < len(first) < 100 else next(iter(classified), "")


def pages(folder: Path) -> str:
    """The document of the pages' packages."""
    command = ["npm", "sbom", "--sbom-format", "cyclonedx", "--package-lock-only"]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True).stdout


def wrong(document: str) -> str | None:
    """Why it is not a document of CycloneDX 1.5; None if it is."""
    found = JsonStrictValidator(SchemaVersion.V1_5).validate_str(document)
    return None if found is None else f"{found.data.message}"[:400]


def main() -> int:
    """Write and validate both; 1 if one is not valid."""
    folder = ROOT / "build" / "sbom"
    folder.mkdir(parents=True, exist_ok=True)
    lock = (ROOT / "requirements.lock").read_text(encoding="utf-8")
    for name, document in (("python", python(lock)), ("pages", pages(ROOT / "frontend"))):
        fault = wrong(document)
        if fault is not None:
            print(f"{name}: not valid as CycloneDX 1.5: {fault}", file=sys.stderr)
            return 1
        file = folder / f"{name}.cdx.json"
        file.write_text(document, encoding="utf-8")
        print(f"{file.relative_to(ROOT)}: {len(json.loads(document)['components'])} components, valid")
    return 0


if __name__ == "__main__":
    sys.exit(main())
