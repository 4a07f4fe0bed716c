"""`clearance worker`: claims runs from the queue and executes them until it is stopped; `clearance worker drain NAME`.

The work is done in `worker.running.processes.supervisor`.
"""

from __future__ import annotations

import logging
import os
import signal
import socket
import time
from typing import Annotated

import typer

from campaigns import logs
from campaigns.runs import run_name
from clearance.cli import WrongInputError, refusing
from clearance.cli import _evaluator as evaluators
from clearance.cli._where import DATA, Data, Database, existing_url_of, opened, reading, url_of

DRAINED = 10
"""The exit code of a worker that was drained: it is not started again."""

app = typer.Typer(invoke_without_command=True)


@app.callback()
def worker(
    ctx: typer.Context,
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
            help="Time (seconds) without a new result after which a run's process is replaced; longer where its "
            "evaluations take long or its results came slowly. A function evaluated in the process itself may take any "
            "time.",
        ),
    ] = 600.0,
) -> None:
    """Execute runs from the queue, one at a time on all cores: several divide them by CLEARANCE_THREADS. Ctrl-C returns
    the run to the queue."""
    if ctx.invoked_subcommand is not None:
        return
    from backend.db.private import UMASK
    from worker.engine.kernels import jit
    from worker.running.catalogue.files import unusable_simulators
    from worker.running.processes import memory
    from worker.running.processes.supervisor import Supervisor, default_name

    if check:
        from backend.db import workers

        with reading(existing_url_of(data, database)) as connection:
            raise typer.Exit(0 if workers.alive(connection, socket.gethostname()) else 1)
    jit.refuse(jit.by_environment())
    evaluators.use(evaluator)
    with refusing(ValueError):
        memory.refuse()
        logs.set_up(os.environ, "%(asctime)s %(levelname)s %(message)s")
    logging.getLogger("alembic").setLevel(logging.WARNING)
    os.umask(UMASK)
    for problem in unusable_simulators():
        logging.warning("a simulator is skipped: %s", problem)
    url = url_of(data, database)
    _once_it_answers(url)
    with refusing(ValueError):
        supervisor = Supervisor(
            url, name or default_name(), runner=runner, lease=lease, standstill=standstill, data=data
        )
    stopped_by = supervisor.run()
    raise typer.Exit(130 if stopped_by == signal.SIGINT else DRAINED if supervisor.drained and not stopped_by else 0)


@app.command()
def drain(
    name: Annotated[str, typer.Argument(help="The worker's name, as the pages and `clearance doctor` show it.")],
    data: Data = DATA,
    database: Database = "",
) -> None:
    """Have a worker finish its run, take no further one, and end: before an update, or to use its machine otherwise."""
    from backend.db import workers

    with opened(data, database) as connection:
        try:
            run = workers.drain(connection, name)
        except KeyError:
            live = ", ".join(workers.live(connection)) or "none"
            raise WrongInputError(f"there is no live worker {name!r}; live are: {live}") from None
    typer.echo(f"{name} takes no further run and ends" + (f" when {run_name(run)} has ended." if run else "."))


def _once_it_answers(url: str) -> None:
    """Migrate the database, however long its server is away; a file that cannot be used ends the worker at once."""
    from backend.db.availability import PAUSE, awaited, sentence

    while (away := awaited(url)) is not None:
        logging.warning("%s", sentence(away))  # one line a minute
        time.sleep(PAUSE)
