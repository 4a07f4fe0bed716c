"""The content of a capsule: a finding with its campaign, components, versions, trajectories and digests.

Nothing in it is executed when it is read. When it is replayed, the components of the installation evaluate the finding
again, unless the user permits the code in the capsule.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import Annotated, Any, Literal

from campaigns.asked.load import load_document
from campaigns.asked.spec import Campaign
from campaigns.capsules.sources import Part, Sources
from campaigns.catalogue import Catalogue
from campaigns.documented import UNLESS_NONE
from campaigns.results import Finding, TraceHead
from campaigns.results.measured import Measured
from campaigns.results.trace import TraceColumn
from campaigns.versions import Versions

FORMAT = "clearance-capsule/1"


class Origin(Part):
    """The run that the finding is of."""

    run: str
    """R-0001, or empty for a run without a service."""
    name: str
    verdict: str
    sentence: str
    results: str
    """Digest of the run's results, as sign-offs and reports state it; empty without a service."""


class Trajectory(Part):
    """A trace without its data, which is in the file NAME.npy, (rows, columns)."""

    name: str
    columns: list[TraceColumn]
    head: TraceHead


class Capsule(Part):
    """The document capsule.json."""

    format: Literal["clearance-capsule/1"]
    made_by: str
    """Version of Clearance."""
    origin: Origin
    campaign: dict[str, object]
    campaign_digest: str
    finding: Finding
    versions: Versions
    modules: dict[str, str]
    """The digest of each module of the code that ran the run; empty if not stored."""
    components: dict[str, object] | None
    """The descriptions of components and methods as of the run: texts, equations, units, limits; null if not stored."""
    components_digest: str
    measured: Measured | None
    """Whether a simulator repeated."""
    program: dict[str, object] | None
    """The command of a simulator, if the campaign file gave it: code, which is used only if that is permitted."""
    sources: Annotated[Sources | None, UNLESS_NONE] = None
    """The source of components and methods that are not shipped: code, which is used only if that is permitted."""
    trajectories: list[Trajectory]
    files: dict[str, str]
    """SHA-256 of every other file in the capsule."""
    digest: str
    """SHA-256 of this document without this key, as canonical JSON."""

    @property
    def specification(self) -> Campaign:
        """The campaign; raises `CampaignError`."""
        return load_document(self.campaign, "the campaign of the capsule")

    @property
    def described(self) -> Catalogue | None:
        """The descriptions of the components."""
        return None if self.components is None else Catalogue.model_validate(self.components)


def digest_of(document: Mapping[str, Any]) -> str:
    """SHA-256 of a document without its digest, 64 hexadecimal digits."""
    content = {name: value for name, value in document.items() if name != "digest"}
    canonical = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False, ensure_ascii=False)
    return hashlib.sha256(canonical.encode("utf-8", "surrogatepass")).hexdigest()
