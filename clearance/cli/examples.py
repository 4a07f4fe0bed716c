"""`clearance examples`: copies the simulators, components and campaigns that the guides name to where they name them.

A clone has them in `docs/examples`. A wheel has them among its data files, because they are no part of the code.
"""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated

import typer

WHERE = Path("docs/examples")
"""Where the commands of the guides expect them."""
KINDS = {".c", ".ipynb", ".py", ".sh", ".xml", ".yaml"}
"""Suffixes of the files that belong to the examples, not to what was built or compiled from them."""


def examples(
    folder: Annotated[Path, typer.Argument(help="Folder to create.")] = WHERE,
) -> None:
    """Copy the examples of the guides into docs/examples of this folder, where their commands expect them."""
    from campaigns.refusals import RefusalCode
    from clearance.cli import WrongInputError, on_disk

    if folder.exists():
        raise WrongInputError(
            f"{folder} exists and is not overwritten: use the examples there, or name another folder",
            RefusalCode.EXISTS,
        )
    found = shipped()
    if not found:
        raise WrongInputError(
            "this installation has no examples: copy docs/examples of the repository, or install its wheel with pip"
        )
    with on_disk(f"{folder} cannot be written"):
        for file, data in found.items():
            (folder / file).parent.mkdir(parents=True, exist_ok=True)
            (folder / file).write_bytes(data.read_bytes())
    typer.echo(f"{len(found)} files are in {folder}. So that campaigns find the simulators, name the folder:")
    typer.echo(f"  export CLEARANCE_SIMULATORS={shlex.quote(str(folder.absolute()))}")


def shipped() -> dict[Path, Path]:
    """The files of the examples by their path below docs/examples: of the clone, else of the installed package."""
    clone = Path(__file__).parents[2]
    if (clone / "pyproject.toml").is_file():
        every = sorted((clone / WHERE).rglob("*"))  # with what was built there, which is no example
        return {file.relative_to(clone / WHERE): file for file in every if file.is_file() and file.suffix in KINDS}
    return _installed()


def _installed() -> dict[Path, Path]:
    from importlib.metadata import PackageNotFoundError, files

    try:
        listed = files("clearance") or []
    except PackageNotFoundError:
        return {}
    kept = {}
    for file in listed:
        _, named, path = file.as_posix().partition("share/clearance/examples/")
        if named and file.suffix in KINDS:
            kept[Path(path)] = Path(str(file.locate()))
    return kept
