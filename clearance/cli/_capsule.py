"""Capsules on the command line: written by `clearance run --out`, read by `clearance replay FILE`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from campaigns.refusals import RefusalCode
from clearance.cli import WrongInputError
from clearance.cli._capsule_code import is_inside, opened_capsule

if TYPE_CHECKING:
    from campaigns import Campaign
    from campaigns.capsules.capsule import Capsule
    from worker.running.runs.replay import Recorded
    from worker.running.runs.store import MemoryStore

MOST = 5
"""Changes of descriptions that are printed."""


@dataclass(frozen=True)
class Opened:
    """A capsule, and what a replay needs of it."""

    capsule: Capsule
    recorded: Recorded
    executed: str
    """What of the capsule was permitted and executed; empty for nothing."""


def is_capsule(run: str) -> bool:
    """Whether an argument names a file."""
    return Path(run).is_file() or (run.endswith(".zip") and not Path(run).is_dir())


def of_capsule(path: Path, allow_code: bool) -> Opened:
    """Read a capsule; its command is installed for this process only if that is permitted. Raises `WrongInputError`."""
    from worker.running.runs.replay import Recorded

    capsule, _ = opened_capsule(path)
    if capsule.program is not None:
        _install(path, capsule.program, allow_code)
    recorded = Recorded(
        capsule.specification,
        capsule.specification.seed,
        [],
        {},
        [capsule.finding],
        capsule.versions,
        capsule.modules,
        measured=capsule.measured,
    )
    executed = [] if capsule.program is None else ["the command"]
    executed += ["the components"] if is_inside(capsule) else []
    return Opened(capsule, recorded, " and ".join(executed))


def changed(opened: Opened) -> list[str]:
    """What differs between the descriptions of the components in the capsule and those of the installation."""
    from campaigns.checked.snapshot import changes
    from worker.running.catalogue.installed import catalogue

    then = opened.capsule.described
    return [] if then is None else changes(then, catalogue())


def described(opened: Opened, apart: list[str]) -> dict[str, object]:
    """What --json adds for a capsule."""
    capsule = opened.capsule
    origin = capsule.origin.model_dump(mode="json")
    return {"capsule": capsule.digest, "origin": origin, "component_changes": apart, "executed": bool(opened.executed)}


def sentence(opened: Opened, apart: list[str]) -> str:
    """A sentence on the source of the components, and on the differences of their descriptions."""
    by = f"{opened.executed} of the capsule" if opened.executed else "the components of this installation"
    statement = f"Evaluated by {by}" + ("" if opened.executed else "; nothing of the capsule was executed")
    if opened.capsule.described is None:
        return f"{statement}. The capsule has no descriptions of components."
    if not apart:
        return f"{statement}. Their descriptions are those in the capsule."
    rest = f"; and {len(apart) - MOST} more" if len(apart) > MOST else ""
    return f"{statement}. Other than in the capsule: {'; '.join(apart[:MOST])}{rest}."


def write_capsules(folder: Path, campaign: Campaign, store: MemoryStore, program: dict[str, object] | None) -> None:
    """Write capsule-F1.zip for every finding of a run. They have no page: only the service draws."""
    from campaigns.capsules.capsule import Origin, Trajectory
    from campaigns.capsules.packing import Content, packed
    from campaigns.checked.snapshot import snapshot
    from campaigns.claims.spans import words
    from campaigns.versions import Versions
    from worker.running.catalogue.installed import catalogue
    from worker.running.runs import identity

    verdict, nominal = store.verdict, store.stages[0].result
    statement = ("", "") if verdict is None else (str(verdict.verdict), words(verdict.statement))
    for finding in store.findings:
        traces = [store.traces[name] for name in ("nominal", finding.label) if name in store.traces]
        content = Content(
            origin=Origin(run="", name=campaign.name, verdict=statement[0], sentence=statement[1], results=""),
            campaign=campaign.document(),
            campaign_digest=campaign.digest,
            finding=finding,
            versions=store.versions or Versions(),
            modules=identity.code(campaign).modules,
            components=snapshot(campaign, catalogue()),
            measured=None if nominal is None else nominal.repeatability,
            trajectories=[(Trajectory(name=t.name, columns=t.columns, head=t.meta), t.data) for t in traces],
            program=program,
            sources=store.sources,
        )
        (folder / f"capsule-{finding.label}.zip").write_bytes(packed(content))


def _install(path: Path, program: dict[str, object], allowed: bool) -> None:
    from worker.running.catalogue.inline import InlineProgram, descriptor_of, install

    if not allowed:
        raise WrongInputError(
            f"{path} contains the command of a simulator, which is code; for a file that you trust, --allow-code "
            "permits it",
            RefusalCode.CODE_NOT_PERMITTED,
        )
    try:
        folder = Path(str(program["folder"]))
        if not folder.is_dir():
            raise ValueError(f"the folder of its campaign file, {folder}, is not there")
        install(InlineProgram(folder, descriptor_of(program["descriptor"], str(path)), str(program["file"])))
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise WrongInputError(f"the command in {path} cannot be used: {error}") from None
