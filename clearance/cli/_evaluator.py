"""The option --evaluator: where simulators evaluate, instead of in slots of this process."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Annotated, TypeAlias

import typer

from campaigns.refusals import RefusalCode
from clearance.cli import WrongInputError, refusing

if TYPE_CHECKING:
    from campaigns import Campaign

Evaluator: TypeAlias = Annotated[
    str,
    typer.Option(
        "--evaluator", metavar="ADDRESS", show_default=False,
        help="Evaluate simulators on a cluster: dask://HOST:PORT for a Dask scheduler, or local:N for N processes "
        "here; docs/cluster.md. The default is CLEARANCE_EVALUATOR, or slots of this process.",
    ),
]  # fmt: skip


def use(address: str) -> None:
    """Evaluate there from now on; raises `WrongInputError` for an address that cannot be used."""
    from worker.engine.systems.simulators.cluster.address import SETTING, BadEvaluator, chosen

    if address:
        os.environ[SETTING] = address
    with refusing(BadEvaluator):
        chosen()


def refuse_other(address: str, campaign: Campaign) -> None:
    """Refuse a campaign that evaluates in this process although --evaluator was given."""
    if not address:
        return
    if campaign.simulator is None:
        what = "the campaign has a scenario, which is simulated in this process"
    else:
        what = _only_here(campaign.simulator.name)
        if not what:
            return
    raise WrongInputError(f"--evaluator {address}: {what}; leave --evaluator out", RefusalCode.NOT_THERE)


def _only_here(name: str) -> str:
    """Why a simulator evaluates on this machine alone; empty if nodes can evaluate it, or if it is unknown."""
    from worker.engine.systems.simulators.declared.described import Described
    from worker.running.catalogue.files import PythonFunction
    from worker.running.catalogue.installed import simulators

    simulator = simulators().get(name)
    if isinstance(simulator, Described):
        return "the command of the campaign file is installed on no other machine" if simulator.campaign_command else ""
    if isinstance(simulator, PythonFunction) and simulator.declaration.settings.isolated:
        return ""
    return "" if simulator is None else f"simulator {name} is called in this process"
