"""`clearance component new KIND NAME` writes a component to start from, `component check FILE` examines one."""

from __future__ import annotations

import os
import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from campaigns.catalogue import Role
from campaigns.refusals import RefusalCode
from clearance.cli import WrongInputError, _skeleton, on_disk

if TYPE_CHECKING:
    from worker.running.catalogue.own import OwnFile

app = typer.Typer(
    help="Your own vehicles, controllers, avoiders, obstacles, environments, faults and criteria.", no_args_is_help=True
)

UNUSABLE = 1
"""Exit code of a file that cannot be used."""


@app.command()
def new(
    kind: Annotated[Role, typer.Argument(help="Kind of the component.")],
    name: Annotated[str, typer.Argument(help="Name in a campaign: small letters, digits and _.")],
    vehicle: Annotated[
        str, typer.Option("--for", help="For a controller: the vehicle that it controls.", show_default=False)
    ] = "",
) -> None:
    """Write a whole component to start from, with a campaign that runs with it, into the first folder of
    CLEARANCE_COMPONENTS or the current one."""
    from worker.engine.components.own import folders

    if vehicle and kind != "controller":
        raise WrongInputError(f"--for {vehicle}: only a controller is written for a vehicle; leave --for out")
    listed = folders()
    folder = listed[0] if listed else Path.cwd()
    _check_name(kind, name, folder / f"{name}.py")
    texts = _skeleton.files(kind, name, vehicle, folder)
    _write(texts)
    first, *others = map(_shown, texts)
    typer.echo(f"{first} is written: the {kind} {name!r}, with {' and '.join(others)}, which run as they are.")
    typer.echo("Edit it, check it, and run the campaign:")
    typer.echo(f"  clearance component check {first}")
    typer.echo(f"  clearance run {others[-1]}")
    if folder not in listed:
        typer.echo("So that `clearance run`, the service and its workers find it, start them in a shell with:")
        typer.echo(f"  export CLEARANCE_COMPONENTS={shlex.quote(str(folder))}")


def _write(texts: Mapping[Path, str]) -> None:
    """Write new files, all or none."""
    for file in texts:
        if file.exists():
            raise WrongInputError(
                f"{file} exists and is not overwritten: choose another name, or remove it", RefusalCode.EXISTS
            )
    for file, text in texts.items():
        with on_disk(f"{file} cannot be written"), file.open("x", encoding="utf-8") as output:
            output.write(text)


@app.command()
def check(
    files: Annotated[list[Path], typer.Argument(help="Files of components.", show_default=False)],
) -> None:
    """Examine files of components: text, declaration, kernels, a short simulation and the compiler."""
    wrong = 0
    for file in files:
        if not file.is_file():
            what = f"{file} is a folder" if file.is_dir() else f"there is no file {file}"
            raise WrongInputError(f"{what}; give the file of a component, such as my_robot.py", RefusalCode.NO_FILE)
        found = _checked(file.absolute())
        wrong += bool(found.text)
        typer.echo(_sentence(file, found), err=bool(found.text))
    if wrong:
        raise typer.Exit(UNUSABLE)


def _checked(file: Path) -> OwnFile:
    """The examination of a file, next to the others of its folder and of the operator's folders."""
    from worker.engine.components.own import FOLDERS, folders
    from worker.running.catalogue import own

    searched = [file.parent, *(folder for folder in folders() if folder != file.parent)]
    os.environ[FOLDERS] = os.pathsep.join(map(str, searched))
    found = own.examine(file)
    return found if found.text else own.beside_others(found)


def _sentence(file: Path, found: OwnFile) -> str:
    if found.text:
        return f"{file}{f', line {found.line}' if found.line else ''}: {found.text}"
    end = "" if found.simulated else "; it was not simulated: no vehicle that it fits can be used"
    end += f"; {found.note}" if found.note else ""
    return f"{file}: the {found.role} {found.name!r} can be used{end}"


def _check_name(kind: Role, name: str, file: Path) -> None:
    from worker.running.catalogue import own
    from worker.running.examination.mistake import Mistake
    from worker.running.examination.naming import check_name

    try:
        check_name(kind, name)
    except Mistake as mistake:
        raise WrongInputError(mistake.text) from None
    taken = own.declaring(kind, name, file.parent)
    if taken is not None and taken != file:
        raise WrongInputError(
            f"{taken} already declares the {kind} {name!r}: choose another name", RefusalCode.NAME_TAKEN
        )


def _shown(file: Path) -> str:
    try:
        return shlex.quote(str(file.relative_to(Path.cwd())))
    except ValueError:
        return shlex.quote(str(file))
