"""The provenance stored with results so that they can be reproduced: code, versions, machine, settings.

Stored when the first stage of a run begins; a run begun by other code is refused.
"""

from __future__ import annotations

import platform
from importlib.metadata import version
from pathlib import Path

from llvmlite import binding

from campaigns.asked.spec import Campaign
from campaigns.versions import Processor, Versions
from worker.engine.kernels.numba_internals import processor_features
from worker.engine.stages.parts.store import Store
from worker.engine.systems.base import System, slotted
from worker.running.runs import sources
from worker.running.runs.added import added


def begin(store: Store, system: System, campaign: Campaign) -> None:
    """Store the present versions, and the source of what is not shipped; raises `backend.db.store.OtherCode` if the run
    was begun by other code."""
    store.record_versions(versions(system), sources.code())
    found = added(campaign)
    if found is not None:
        store.record_sources(*found)


def versions(system: System) -> Versions:
    """The versions of the code and packages of this process, the processor, the system."""
    settings = system.settings
    called = None if settings.integrator else slotted(system)
    return Versions(
        clearance=version("clearance"),
        python=platform.python_version(),
        code=sources.code().digest,
        packages=dict(sources.LOADED.packages),
        system=f"{platform.system()} {platform.machine()}",
        cpu=_processor(),
        lanes=settings.lanes,
        step=settings.step,
        integrator=settings.integrator,
        loop=system.digest if called is None else None,
        components=sources.own(settings.own),
        simulator=None if called is None else called.digest,
        evaluator=(called and called.elsewhere) or None,
        command=(called and called.given) or None,
    )


def _processor() -> Processor:
    return Processor(model=_model(), target=binding.get_host_cpu_name(), features=" ".join(processor_features()))


def _model() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor()
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "")
