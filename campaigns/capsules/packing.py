"""Writes a capsule as a zip file, and reads one that may come from anyone.

Reading is bounded: known names only, sizes by what is decompressed and not by what the file claims, numbers as raw
doubles, no pickles, nothing written to disk.
"""

from __future__ import annotations

import hashlib
import io
import json
import re
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from pydantic import ValidationError

from campaigns.asked.problem import CampaignError
from campaigns.asked.reading import repeated
from campaigns.capsules.capsule import FORMAT, Capsule, Origin, Trajectory, digest_of
from campaigns.capsules.sources import LARGEST as LARGEST_SOURCE
from campaigns.capsules.sources import Sources
from campaigns.catalogue import Catalogue
from campaigns.cube import Floats
from campaigns.documents import digest_of as described_digest
from campaigns.results import Finding
from campaigns.results.measured import Measured
from campaigns.unreadable import UNREADABLE
from campaigns.version import VERSION
from campaigns.versions import Versions

DOCUMENT, PAGE = "capsule.json", "flight.html"
LARGEST_FILE = 64 * 2**20
"""Maximum size of a capsule [bytes]."""
LARGEST = {DOCUMENT: 32 * 2**20, PAGE: 32 * 2**20, ".npy": 64 * 2**20, ".py": LARGEST_SOURCE}
"""Maximum size of each kind of file in it, decompressed [bytes]."""

_TRAJECTORY = re.compile(r"(nominal|F[1-9][0-9]{0,3})\.npy")
_SOURCE = re.compile(r"source/([A-Za-z0-9_.]{1,200})\.py")
_AT = (1980, 1, 1, 0, 0, 0)
"""The time of every file in a capsule, so that the same content gives the same bytes."""
_MAGIC = b"\x93NUMPY\x01\x00"
_HEADER = re.compile(rb"\{'descr': '<f8', 'fortran_order': False, 'shape': \(([0-9]{1,9}), ([0-9]{1,9})\), \} *\n")
_CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")
"""Control characters, and those that turn the direction of writing."""
_LABEL = re.compile(r"F[1-9][0-9]{0,3}")
_COMPRESSIONS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
_ENTRY, _MOST_ENTRIES = b"PK\x01\x02", 100
"""How a zip file begins each entry of its directory; a capsule has a few."""


class CapsuleError(ValueError):
    """A file is no capsule that can be used; the message states what is wrong with it."""


@dataclass(frozen=True)
class Content:
    """What a capsule is made of, besides what follows from it."""

    origin: Origin
    campaign: dict[str, object]
    campaign_digest: str
    finding: Finding
    versions: Versions
    modules: Mapping[str, str]
    components: Catalogue | None
    measured: Measured | None
    trajectories: Sequence[tuple[Trajectory, Floats]]
    program: dict[str, object] | None = None
    sources: tuple[Sources, Mapping[str, bytes]] | None = None
    """The source of what is not shipped, and its texts by module."""
    page: str = ""
    """The recording of the finding in 3D, one self-contained page; empty if there is none."""


def packed(content: Content) -> bytes:
    """The capsule as a file."""
    files = {f"{head.name}.npy": _array(data) for head, data in content.trajectories}
    if content.page:
        files[PAGE] = content.page.encode()
    if content.sources is not None:
        files |= {f"source/{module}.py": text for module, text in content.sources[1].items()}
    components = None if content.components is None else content.components.model_dump(mode="json")
    document: dict[str, object] = {
        "format": FORMAT,
        "made_by": VERSION,
        "origin": content.origin.model_dump(mode="json"),
        "campaign": content.campaign,
        "campaign_digest": content.campaign_digest,
        "finding": content.finding.model_dump(mode="json"),
        "versions": content.versions.model_dump(mode="json"),
        "modules": dict(content.modules),
        "components": components,
        "components_digest": "" if components is None else described_digest(components),
        "measured": None if content.measured is None else content.measured.model_dump(mode="json"),
        "program": content.program,
        "trajectories": [head.model_dump(mode="json") for head, _ in content.trajectories],
        "files": {name: hashlib.sha256(data).hexdigest() for name, data in files.items()},
    }
    if content.sources is not None:
        document["sources"] = content.sources[0].model_dump(mode="json")
    document["digest"] = digest_of(document)
    text = json.dumps(document, indent=1, allow_nan=False, ensure_ascii=False)
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in {DOCUMENT: text.encode("utf-8", "surrogatepass"), **files}.items():
            archive.writestr(zipfile.ZipInfo(name, _AT), data, zipfile.ZIP_DEFLATED)
    return buffer.getvalue()


class Unpacked(NamedTuple):
    """A capsule, the data of its trajectories by name, each (rows, columns), and its source texts by module."""

    capsule: Capsule
    arrays: dict[str, Floats]
    sources: dict[str, bytes]


def read(path: Path) -> Unpacked:
    """A capsule from a file. Raises `CapsuleError`."""
    try:
        with path.open("rb") as file:
            data = file.read(LARGEST_FILE + 1)
    except OSError as error:
        raise CapsuleError(f"it cannot be read: {error.strerror}") from None
    return unpacked(data)


def unpacked(data: bytes) -> Unpacked:
    """A capsule from the bytes of its file. Raises `CapsuleError`."""
    if len(data) > LARGEST_FILE:
        raise CapsuleError(f"it is larger than {LARGEST_FILE // 2**20} MiB")
    files = _files(data)
    capsule = _document(files.pop(DOCUMENT, None))
    if {name: hashlib.sha256(content).hexdigest() for name, content in files.items()} != capsule.files:
        raise CapsuleError("its files are not those that it states: it was changed")
    _consistent(capsule)
    texts = {found[1]: files.pop(name) for name in list(files) if (found := _SOURCE.fullmatch(name))}
    faults = "its sources are not those that it states" if texts else ""
    faults = faults if capsule.sources is None else capsule.sources.faults(texts)
    if faults:
        raise CapsuleError(faults)
    arrays = {t.name: _numbers(t, files.get(f"{t.name}.npy")) for t in capsule.trajectories}
    if len(arrays) != sum(name != PAGE for name in files) or len(arrays) != len(capsule.trajectories):
        raise CapsuleError("its trajectories are not those that it states")
    return Unpacked(capsule, arrays, texts)


def _files(data: bytes) -> dict[str, bytes]:
    found: dict[str, bytes] = {}
    if data.count(_ENTRY) > _MOST_ENTRIES:
        raise CapsuleError("it contains more files than any capsule does")
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            for entry in archive.infolist():
                name = entry.filename
                if not (name in LARGEST or _TRAJECTORY.fullmatch(name) or _SOURCE.fullmatch(name)) or name in found:
                    raise CapsuleError(f"it contains {name[:60]!r}, or that twice, which no capsule does")
                if entry.compress_type not in _COMPRESSIONS:  # others take memory as the file states, up to 4 GiB
                    raise CapsuleError(f"{name} in it is not compressed as a capsule is")
                most = LARGEST.get(name, LARGEST[".py" if name.endswith(".py") else ".npy"])
                with archive.open(entry) as file:
                    found[name] = file.read(most + 1)
                if len(found[name]) > most or sum(map(len, found.values())) > 2 * LARGEST_FILE:
                    raise CapsuleError(f"{name} in it is larger than is allowed")
    except CapsuleError:
        raise
    except UNREADABLE as error:
        raise CapsuleError(f"it is not a zip file of a capsule: {error}") from None
    return found


def _document(text: bytes | None) -> Capsule:
    if text is None:
        raise CapsuleError(f"it contains no {DOCUMENT}")
    try:
        document = json.loads(text.decode("utf-8", "surrogatepass"), object_pairs_hook=_once)
    except CapsuleError:
        raise
    except (ValueError, RecursionError):
        raise CapsuleError(f"{DOCUMENT} in it is not JSON") from None
    if not isinstance(document, dict) or document.get("format") != FORMAT:
        raise CapsuleError(f"{DOCUMENT} in it is not of the format {FORMAT}: another version of Clearance wrote it")
    try:
        _printable(document)
        if document.get("digest") != digest_of(document):
            raise CapsuleError(f"the digest of {DOCUMENT} in it is wrong: it was changed")
        return Capsule.model_validate(document)
    except CapsuleError:
        raise
    except ValidationError as error:
        first = error.errors(include_url=False, include_context=False, include_input=False)[0]
        place = ".".join(map(str, first["loc"]))
        raise CapsuleError(f"{DOCUMENT} in it is invalid: {place[:100]}: {first['msg']}") from None
    except (ValueError, RecursionError) as error:
        raise CapsuleError(f"{DOCUMENT} in it is invalid: {error}"[:300]) from None


def _once(pairs: list[tuple[str, object]]) -> object:
    """An object; refused if it gives a key twice, of which each reader takes another value."""
    twice = repeated(name for name, _ in pairs)
    if twice is not None:
        raise CapsuleError(f"{DOCUMENT} in it gives the key {twice[:60]!r} twice: it was changed")
    return dict(pairs)


def _printable(value: object) -> None:
    """Refuse control characters in any text: what is printed of a capsule must not steer a terminal."""
    if isinstance(value, dict):
        for key, one in value.items():
            _printable(key)
            _printable(one)
    elif isinstance(value, list):
        for one in value:
            _printable(one)
    elif isinstance(value, str) and _CONTROL.search(value):
        raise CapsuleError(f"{DOCUMENT} in it contains control characters")


def _consistent(capsule: Capsule) -> None:
    """What the document states of itself is true: its digests, and that the finding is one of the campaign."""
    try:
        campaign = capsule.specification
    except CampaignError as error:
        raise CapsuleError(f"its campaign cannot be read: {error}") from None
    if campaign.digest != capsule.campaign_digest:
        raise CapsuleError("the digest of its campaign is wrong: it was changed, or written by another version")
    if capsule.components is not None and described_digest(capsule.components) != capsule.components_digest:
        raise CapsuleError("the digest of its components is wrong: it was changed")
    seed = capsule.finding.realisation
    if not _LABEL.fullmatch(capsule.finding.label) or not (seed is None or 0 <= seed < 2**63):
        raise CapsuleError("the label or the noise seed of its finding is invalid")
    if set(capsule.finding.parameters) != set(campaign.uncertain):
        raise CapsuleError("the parameters of its finding are not those of its campaign")


def _array(data: Floats) -> bytes:
    buffer = io.BytesIO()
    np.lib.format.write_array(buffer, np.ascontiguousarray(data, dtype="<f8"), version=(1, 0), allow_pickle=False)
    return buffer.getvalue()


def _numbers(trajectory: Trajectory, file: bytes | None) -> Floats:
    """The rows of a file of numpy's format 1.0 with doubles; its header never decides how much memory is taken."""
    wrong = CapsuleError(f"{trajectory.name}.npy in it is missing or does not have the stated columns as doubles")
    if file is None or not file.startswith(_MAGIC):
        raise wrong
    start = len(_MAGIC) + 2
    end = start + int.from_bytes(file[start - 2 : start], "little")
    header = _HEADER.fullmatch(file[start:end])
    rows, columns = (int(header[1]), int(header[2])) if header else (-1, -1)
    if columns != len(trajectory.columns) or len(file) - end != 8 * rows * columns:
        raise wrong
    return np.frombuffer(file, dtype="<f8", offset=end).reshape(rows, columns)
