"""`clearance component new KIND NAME` writes a component to start from, `component check FILE` examines one."""

from __future__ import annotations

import enum
import os
import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from campaigns.refusals import RefusalCode
from clearance.cli import WrongInputError

if TYPE_CHECKING:
    from worker.running.catalogue.own import OwnFile

app = typer.Typer(
    help="Your own vehicles, controllers, avoiders, obstacles, faults and criteria.", no_args_is_help=True
)

UNUSABLE = 1
"""Exit code of a file that cannot be used."""


class Kind(enum.StrEnum):
    """The kinds of component that `new` writes."""

    VEHICLE = "vehicle"
    CONTROLLER = "controller"
    AVOIDER = "avoider"
    OBSTACLE = "obstacle"
    FAULT = "fault"
    CRITERION = "criterion"


@app.command()
def new(
    kind: Annotated[Kind, typer.Argument(help="Kind of the component.")],
    name: Annotated[str, typer.Argument(help="Name in a campaign: small letters, digits and _.")],
    vehicle: Annotated[
        str, typer.Option("--for", help="For a controller: the vehicle that it controls.", show_default=False)
    ] = "",
) -> None:
    """Write a whole component to start from, into the first folder of CLEARANCE_COMPONENTS or the current one."""
    from worker.engine.components.own import folders

    if vehicle and kind is not Kind.CONTROLLER:
        raise WrongInputError(f"--for {vehicle}: only a controller is written for a vehicle; leave --for out")
    listed = folders()
    folder = listed[0] if listed else Path.cwd()
    file = folder / f"{name}.py"
    _check_name(kind, name, file)
    text = _written(kind, name, _fitting(vehicle) if kind is Kind.CONTROLLER else ())
    try:
        with file.open("x", encoding="utf-8") as output:
            output.write(text)
    except FileExistsError:
        raise WrongInputError(
            f"{file} exists and is not overwritten: choose another name, or remove it", RefusalCode.EXISTS
        ) from None
    except OSError as error:
        raise WrongInputError(f"{file} cannot be written: {error.strerror}") from None
    typer.echo(f"{file} is written: the {kind} {name!r}, which can be simulated as it is. Edit it, then check it:")
    typer.echo(f"  clearance component check {_shown(file)}")
    if folder not in listed:
        typer.echo("So that campaigns, the service and its workers find it, start them in a shell with:")
        typer.echo(f"  export CLEARANCE_COMPONENTS={shlex.quote(str(folder))}")


@app.command()
def check(
    files: Annotated[list[Path], typer.Argument(help="Files of components.", show_default=False)],
) -> None:
    """Examine files of components: text, declaration, kernels, a short simulation and the compiler."""
    wrong = 0
    for file in files:
        if not file.is_file():
            raise WrongInputError(
                f"there is no file {file}; give the file of a component, such as my_robot.py", RefusalCode.NO_FILE
            )
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
    if found.text:
        return found
    return own.beside_others(found)


def _sentence(file: Path, found: OwnFile) -> str:
    if found.text:
        return f"{file}{f', line {found.line}' if found.line else ''}: {found.text}"
    end = "" if found.simulated else "; it was not simulated: no vehicle that it fits can be used"
    end += f"; {found.note}" if found.note else ""
    return f"{file}: the {found.role} {found.name!r} can be used{end}"


def _check_name(kind: Kind, name: str, file: Path) -> None:
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


def _fitting(vehicle: str) -> tuple[str, ...]:
    """The vehicles that the skeleton of a controller fits: the one asked for, or all whose states it assumes.

    Read from the files as they are written: nothing is executed.
    """
    from worker.running.catalogue import own

    shipped = Path(__file__).parents[2] / "worker" / "engine" / "components" / "vehicles"
    files = [*sorted(shipped.glob("*.py")), *own.files(), *sorted(Path.cwd().glob("*.py"))]
    known: dict[str, own.Signals | None] = {}
    for file in files:
        declared = own.declared_as(file)
        if declared is not None and declared[0] == "Vehicle":
            known.setdefault(declared[1], own.signals(file))
    pattern = known["unicycle"]
    assert pattern is not None
    fits = [name for name, signals in known.items() if signals == pattern]
    if not vehicle:
        return tuple(fits)
    if vehicle in fits:
        return (vehicle,)
    if vehicle not in known:
        from campaigns.checked import texts

        raise WrongInputError(f"--for {vehicle}: no such vehicle; {texts.known(vehicle, known)}")
    raise WrongInputError(
        f"--for {vehicle}: the template is for the states {', '.join(pattern.states)} and the inputs "
        f"{' and '.join(pattern.inputs)}; begin with a copy of a controller for a vehicle like yours, from "
        "worker/engine/components/controllers"
    )


def _written(kind: Kind, name: str, fits: tuple[str, ...]) -> str:
    """The skeleton of this kind under this name."""
    skeleton = Path(__file__).parents[2] / "worker" / "running" / "skeletons" / f"{kind}.py"
    text = skeleton.read_text(encoding="utf-8")
    title = name.replace("_", " ").capitalize()
    type_name = "".join(part.capitalize() for part in name.split("_"))
    text = text.replace(f"my_{kind}", name).replace(f"My{kind.capitalize()}", type_name).replace(f"My {kind}", title)
    if fits:
        text = text.replace(
            'fits=("unicycle",)', f"fits=({', '.join(f'{each!r}' for each in fits)},)".replace("'", '"')
        )
    return text


def _shown(file: Path) -> str:
    """A file as short as possible."""
    try:
        return shlex.quote(str(file.relative_to(Path.cwd())))
    except ValueError:
        return shlex.quote(str(file))
