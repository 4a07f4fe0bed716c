"""Whether this installation may continue a run: `readable` before anything is opened or compiled, `elsewhere` after."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from campaigns import Campaign, CampaignError
from campaigns.asked.load import load_document
from campaigns.identity.identity import differences, identity_of, is_read, simulator_of
from campaigns.stored.records import Begun
from campaigns.versions import NOT_INSTALLED, OtherCode, differing
from worker.running.catalogue.digests import digest_of
from worker.running.runs import identity, provenance
from worker.running.runs.replay import other_machine


def readable(
    document: Mapping[str, object], source: str, begun: Begun | None, newer: Callable[[], bool] = lambda: False
) -> Campaign:
    """The campaign of a run that this installation may execute; raises `OtherCode` if other code began it, and
    `CampaignError` if it cannot be read. begun: by which code; None if nothing has been evaluated; newer: whether it
    was submitted for a newer version."""
    try:
        campaign = load_document(document, source)
    except CampaignError as error:
        if begun is None and not newer():
            raise
        raise OtherCode(f"this version cannot read its campaign ({error})") from None
    others = [] if begun is None else _others(begun, campaign)
    if others:
        raise OtherCode("; ".join(others))
    return campaign


def elsewhere(begun: Begun | None) -> list[str]:
    """Why a method may request other points here than where the run was begun, though its code does not differ as far
    as that was stored."""
    if begun is None:
        return []
    then = begun.versions
    undigested = [] if then.code else ["a version began it that stored no digests of its code"]
    return undigested + (other_machine(then, provenance.machine()) if then.cpu else [])


def _others(begun: Begun, campaign: Campaign) -> list[str]:
    """What differs as far as it is known without opening the system; the rest is compared when the run is begun."""
    here = identity.code(campaign)
    if begun.versions.code and not here.digest:
        return [f"a component, method or stage of it {NOT_INSTALLED}"]
    modules = differing(begun.modules, here.modules) if begun.modules else []
    name, then, now = simulator_of(campaign), begun.versions, identity.versions(campaign)
    if digest := digest_of(name) if is_read(then.simulator) and not then.command else "":
        now = now.model_copy(update={"simulator": digest})
    known = name if digest else ""
    return differences(identity_of(then, known), identity_of(now, known), modules)
