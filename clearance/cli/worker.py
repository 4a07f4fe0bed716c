"""`clearance worker`: claims runs from the queue and executes them until it is stopped.

The work is done in `worker.running.processes.supervisor`.
"""

from __future__ import annotations

import logging
import os
import signal
import socket
from pathlib import Path
from typing import Annotated

import typer

from clearance.cli import _evaluator as evaluators
from clearance.cli._where import DATA, Data, Database, reading, url_of


def worker(
    data: Data = DATA,
    database: Database = "",
    check: Annotated[
        bool, typer.Option("--check", help="Only report, by the exit code, whether a worker on this machine is alive.")
    ] = False,
    name: Annotated[str, typer.Option(help="Name shown next to the worker's runs; default: machine:process.")] = "",
    evaluator: evaluators.Evaluator = "",
    runner: Annotated[str, typer.Option(hidden=True)] = "worker.running.runs.runner:execute",
    lease: Annotated[float, typer.Option(hidden=True, min=0.5)] = 10.0,
    standstill: Annotated[
        float,
        typer.Option(
            min=1.0,
            help="Time without a new result [s] after which a run's process is replaced; longer where its evaluations "
            "take long or its results came slowly. A function evaluated in the process itself may take any time.",
        ),
    ] = 600.0,
) -> None:
    """Execute runs from the queue. Start as many as there are cores; Ctrl-C returns the run to the queue."""
    from backend.db.engine import migrate
    from backend.db.private import UMASK
    from worker.engine.kernels import jit
    from worker.running.catalogue.files import unusable_simulators
    from worker.running.processes.supervisor import Supervisor, default_name

    if check:
        raise typer.Exit(0 if _alive(data, database) else 1)
    jit.refuse(jit.by_environment())
    evaluators.use(evaluator)
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(levelname)s %(message)s")
    logging.getLogger("alembic").setLevel(logging.WARNING)
    os.umask(UMASK)
    for problem in unusable_simulators():
        logging.warning("a simulator is skipped: %s", problem)
    url = url_of(data, database)
    migrate(url)
    stopped_by = Supervisor(url, name or default_name(), runner=runner, lease=lease, standstill=standstill).run()
    raise typer.Exit(130 if stopped_by == signal.SIGINT else 0)


def _alive(data: Path, database: str) -> bool:
    from backend.db import workers

    with reading(url_of(data, database)) as connection:
        return workers.alive(connection, socket.gethostname())
