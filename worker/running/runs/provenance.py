"""The provenance stored with results so that they can be reproduced: code, versions, machine, settings.

Stored when the first stage of a run begins; a run begun by other code is refused.
"""

from __future__ import annotations

import platform
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

from llvmlite import binding

from campaigns.asked.spec import Campaign
from campaigns.claims.wording import WORDING
from campaigns.identity.identity import identity_of, simulator_of
from campaigns.stored.records import StageRecord
from campaigns.versions import Processor, Versions
from worker.engine.kernels.numba_internals import processor_features
from worker.engine.stages.parts.store import Store
from worker.engine.systems import optional
from worker.engine.systems.base import System, slotted
from worker.running.runs import identity
from worker.running.runs.own_sources import added
from worker.running.runs.valid_evaluations import valid


def begin(store: Store, system: System, campaign: Campaign, records: Sequence[StageRecord]) -> None:
    """Store the present versions, the source of what is not shipped, and the evaluations that a new run begins with.

    Raises `OtherCode` if the run was begun by other code, or if only that of the run which it continues can begin it.
    """
    here = versions(campaign, system)
    sound = valid(store, identity_of(here, simulator_of(campaign)), campaign, records)
    store.record_versions(here, identity.code(campaign))
    for position, (columns, ahead) in sound.items():
        store.append(position, 0, columns, ahead)
    found = added(campaign)
    if found is not None:
        store.record_sources(*found)


def versions(campaign: Campaign, system: System) -> Versions:
    """The versions of the code and packages that a run of the campaign uses, the processor, the system."""
    settings, here = optional.settings(system), machine()
    called = None if settings.integrator else slotted(system)
    system_values = {
        "clearance": version("clearance"),
        "wording": WORDING,
        "system": here.system,
        "cpu": here.cpu,
        "lanes": settings.lanes,
        "step": settings.step,
        "integrator": settings.integrator,
        "loop": system.digest if called is None else None,
        "simulator": None if called is None else called.digest,
        "evaluator": (called and called.elsewhere) or None,
        "command": (called and called.campaign_command) or None,
    }
    return identity.versions(campaign).model_copy(update=system_values)


def identified(campaign: Campaign, loop: str | None = None, simulator: str | None = None) -> object:
    """The identity of a simulation in this process as JSON, with the digest of its compiled loop or simulator."""
    on = machine()
    evaluating = {"system": on.system, "cpu": on.cpu, "loop": loop, "simulator": simulator}
    here = identity.versions(campaign).model_copy(update=evaluating)
    return identity_of(here, simulator_of(campaign)).model_dump(mode="json")


def machine() -> Versions:
    """The part of the versions that is of this machine."""
    features = " ".join(processor_features())
    processor = Processor(model=_model(), target=binding.get_host_cpu_name(), features=features)
    return Versions(system=f"{platform.system()} {platform.machine()}", cpu=processor)


def _model() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor()
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "")
