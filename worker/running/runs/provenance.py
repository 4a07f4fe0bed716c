"""The provenance stored with results so that they can be reproduced: code, versions, machine, settings.

Stored when the first stage of a run begins; a run begun by other code is refused.
"""

from __future__ import annotations

import platform
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

from llvmlite import binding
from numba.core.codegen import get_host_cpu_features

from campaigns.asked.spec import Campaign
from campaigns.identity import model_of
from campaigns.versions import Processor, Versions
from worker.engine.stages.parts.store import StageRecord, Store
from worker.engine.systems.base import System
from worker.running.runs import identity, sources
from worker.running.runs.added import added
from worker.running.runs.carried import carry


def begin(store: Store, system: System, campaign: Campaign, records: Sequence[StageRecord]) -> None:
    """Store the present versions, the source of what is not shipped, and the evaluations that a new run begins with.

    Raises `OtherCode` if the run was begun by other code.
    """
    here = versions(campaign, system)
    store.record_versions(here, identity.code(campaign))
    carry(store, here, records)
    found = added(campaign)
    if found is not None:
        store.record_sources(*found)


def versions(campaign: Campaign, system: System) -> Versions:
    """The versions of the code and packages that a run of the campaign uses, the processor, the system."""
    return Versions(
        clearance=version("clearance"),
        python=platform.python_version(),
        code=identity.code(campaign).digest or None,
        model=model_of(campaign, identity.code_parts()),
        packages=identity.packages(campaign),
        system=f"{platform.system()} {platform.machine()}",
        cpu=_processor(),
        lanes=system.settings.lanes,
        step=system.settings.step,
        integrator=system.settings.integrator,
        loop=system.digest if system.settings.integrator else None,
        components=sources.own(system.own),
        simulator=None if system.settings.integrator else system.digest,
        evaluator=system.elsewhere or None,
        command=system.given or None,
    )


def _processor() -> Processor:
    named: str = get_host_cpu_features()  # type: ignore[no-untyped-call]
    features = sorted(f[1:] for f in named.split(",") if f.startswith("+"))
    return Processor(model=_model(), target=binding.get_host_cpu_name(), features=" ".join(features))


def _model() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor()
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "")
