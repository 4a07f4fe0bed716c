"""The command `clearance`: one file per command, discovered automatically.

A file `some_name.py` here contains the function `some_name` (the command `some-name`), or `app`, a group of commands.
Its heavy imports are inside the function, so that `clearance --help` is fast. Start reading at `main`.
"""

from __future__ import annotations

import importlib
import io
import itertools
import os
import pkgutil
import sys
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import cache
from typing import Any

import sqlalchemy as sa
import typer
from pydantic_core import SchemaError
from typer.core import TyperCommand, TyperGroup

from backend.db.engine import NewerSchemaError
from backend.db.outages import DatabaseOutage
from campaigns.asked.load import CampaignError
from campaigns.refusals import Refusal
from clearance.cli import _witness
from worker.engine.kernels.jit import JitDisabledError

CLEARED, VIOLATED, INCONCLUSIVE, WRONG_INPUT, INTERNAL, INTERRUPTED = 0, 1, 2, 3, 4, 130
"""Exit codes: the verdicts, wrong input or usage, a failure of Clearance itself, interrupted."""
CODES = {"cleared": CLEARED, "violated": VIOLATED, "inconclusive": INCONCLUSIVE}
"""Those of the verdicts."""
ENDLESS = (["serve"], ["worker"])
"""Commands that run until they are ended: no exit code of theirs is a result."""
JOB_FILES = ("junit", "sarif")
"""The options with a file that states from the beginning of a command that there is no verdict yet."""
NOT_A_RESULT = "Internal error in Clearance; this is not a result of your campaign."


class WrongInputError(Refusal):
    """Invalid input; the message is for the user, the code for scripts. Ends the command with `WRONG_INPUT`."""


@contextmanager
def refusing(*kinds: type[Exception]) -> Iterator[None]:
    """Errors of these kinds within the block are wrong input: `WrongInputError` with their message."""
    try:
        yield
    except kinds as error:
        raise WrongInputError(f"{error}") from None


@contextmanager
def on_disk(sentence: str) -> Iterator[None]:
    """An `OSError` within the block is wrong input: `WrongInputError` with this sentence and the system's reason."""
    try:
        yield
    except OSError as error:
        raise WrongInputError(f"{sentence}: {error.strerror or error}") from None


class UnreachableError(Exception):
    """A service that did not answer in time. Ends the command with `INTERNAL`."""


class _Interrupted(Exception):
    """Ctrl-C; the message states what it left behind, if the command reported it."""


class _Commands(TyperGroup):
    """The command line library ends at Ctrl-C without a word: it is raised past it as another exception."""

    def invoke(self, ctx: Any) -> object:
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as error:
            raise _Interrupted(f"{error}") from None


class _Command(TyperCommand):
    """A command whose files of a job are begun also if its arguments cannot be parsed, as of an unknown option."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        words = [*args]
        try:
            return super().parse_args(ctx, args)
        except typer.TyperException:
            for option in self.params:
                file = _value(f"--{option.name}", words) if option.name in JOB_FILES else ""
                if file:
                    with suppress(typer.TyperException, WrongInputError):  # the first error is the one to correct
                        option.handle_parse_result(ctx, {option.name: file}, [])
            raise


def _value(option: str, words: Sequence[str]) -> str:
    """The last value of an option in arguments that cannot be parsed; empty without one."""
    words = [*itertools.takewhile(lambda word: word != "--", words)]
    apart = [value for name, value in itertools.pairwise(words) if name == option and not value.startswith("-")]
    joined = [word.partition("=")[2] for word in words if word.startswith(f"{option}=")]
    return (["", *apart, *joined])[-1]


class _Output(io.TextIOWrapper):
    """The standard output. What is written after its reader has gone is dropped: the exit code is the result, and files
    follow."""

    def write(self, text: str) -> int:
        with self._kept():
            super().write(text)
        return len(text)

    def flush(self) -> None:
        with self._kept():
            super().flush()

    @contextmanager
    def _kept(self) -> Iterator[None]:
        with on_disk("the output cannot be written"):
            try:
                yield
            except BrokenPipeError:
                self.drop()

    def drop(self) -> None:
        """Send to nowhere what follows, and what is still buffered at the end."""
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, self.fileno())
        os.close(nowhere)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and exit; without arguments those of this process, in a child of it."""
    if arguments is not None:
        sys.exit(_written(arguments))
    process_arguments, witness = sys.argv[1:], None
    try:
        witness = None if process_arguments[:1] in ENDLESS else _witness.witnessed(INTERNAL)
        code = _written(process_arguments)
    except KeyboardInterrupt:  # before the command, or after it
        code = INTERRUPTED
    if witness is not None:
        witness.report(code)
    sys.exit(code)


def _written(arguments: Sequence[str]) -> int:
    """The exit code of a command, the output of which is written."""
    plain = sys.stdout
    if not isinstance(plain, io.TextIOWrapper):  # closed, or replaced by the program that called
        return invoke(arguments)
    output = _Output(plain.buffer, plain.encoding, plain.errors, None, plain.line_buffering, plain.write_through)
    sys.stdout = output
    code = invoke(arguments)
    try:
        output.flush()
    except WrongInputError as error:
        _explain(error)
        output.drop()
        return WRONG_INPUT
    return code


def invoke(arguments: Sequence[str]) -> int:
    """Run one command; returns its exit code. Commands end with `typer.Exit(code)` or an error named here."""
    try:
        code = _command()(list(arguments), prog_name="clearance", standalone_mode=False)
    except (typer.TyperException, CampaignError, Refusal, JitDisabledError, NewerSchemaError) as error:
        _explain(error)
        return WRONG_INPUT
    except sa.exc.OperationalError as error:
        typer.echo(f"Error: {_of_the_database(error)}", err=True)
        return INTERNAL
    except UnreachableError as error:
        _explain(error)
        return INTERNAL
    except (KeyboardInterrupt, _Interrupted, typer.Abort) as error:
        typer.echo(f"interrupted: {error}" if f"{error}" else "interrupted", err=True)
        return INTERRUPTED
    except (Exception, SystemExit) as error:  # also code that ends the process, with whatever code
        sentence = _of_a_component(error)
        if sentence:
            typer.echo(f"Error: a component failed: {sentence}", err=True)
            return WRONG_INPUT
        if _of_an_interrupt(error):
            typer.echo("interrupted", err=True)
            return INTERRUPTED
        traceback.print_exc()
        typer.echo(NOT_A_RESULT, err=True)
        return INTERNAL
    return code if isinstance(code, int) else 0


def load() -> None:
    """Load the modules of all commands."""
    _command()


def build() -> typer.Typer:
    """The commands of this folder as one application."""
    app = typer.Typer(
        cls=_Commands,
        help="Searches for the worst case of an obstacle-avoidance system and states what may be claimed.",
        no_args_is_help=True,
        add_completion=False,
        pretty_exceptions_enable=False,
    )
    for name in sorted(m.name for m in pkgutil.iter_modules(__path__) if not m.name.startswith("_")):
        module, command = importlib.import_module(f"{__name__}.{name}"), name.replace("_", "-")
        if hasattr(module, "app"):
            app.add_typer(module.app, name=command)
        else:
            app.command(command, cls=_Command)(getattr(module, name))
    return app


@cache
def _command() -> Callable[..., object]:
    """The command `clearance`, built once: a program may run it several times."""
    command: Callable[..., object] = typer.main.get_command(build())
    return command


def _of_the_database(error: sa.exc.OperationalError) -> str:
    why = " ".join(str(error.orig).split())
    return f"{error} ({why})" if isinstance(error, DatabaseOutage) else f"the database cannot be used: {why}"


def _of_an_interrupt(error: BaseException) -> bool:
    """Whether a library raised the error in place of an interrupt, as pydantic does while a module is loaded."""
    stated = isinstance(error, SchemaError) and KeyboardInterrupt.__name__ in f"{error}"
    return stated or isinstance(error.__cause__, KeyboardInterrupt)


def _of_a_component(error: BaseException) -> str:
    """What went wrong in one of the operator's own components; empty if the error is another one."""
    if "worker.engine.components.own" not in sys.modules:
        return ""
    from worker.running.catalogue.own import blamed

    return blamed(error)


def _explain(error: Exception) -> None:
    if isinstance(error, CampaignError):
        typer.echo(f"{error.source} cannot be used:", err=True)
        for problem in error.problems:
            typer.echo(f"  {problem}", err=True)
    elif hasattr(error, "show"):  # the command line library's own errors include the usage
        error.show()
    else:
        code = getattr(error, "code", "")
        typer.echo(f"Error: {error}{f' [{code}]' if code else ''}", err=True)
