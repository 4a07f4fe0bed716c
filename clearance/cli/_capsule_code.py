"""Replays a capsule with the source that it contains, in a process of its own whose installation has that source.

Only after --allow-code: importing a file runs it. The files are written to a folder that is deleted afterwards, those
of packages with their entry points, so that they are found, examined and compiled as if they were installed.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import typer

from campaigns.refusals import RefusalCode
from clearance.cli import WrongInputError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from campaigns.capsules.capsule import Capsule
    from campaigns.capsules.sources import Sources

INSIDE = "CLEARANCE_CAPSULE_CODE"
"""Set in that process: the digest of the capsule whose source its installation has."""


def is_inside(capsule: Capsule) -> bool:
    """Whether this is the process that has the source of the capsule."""
    return capsule.sources is not None and os.environ.get(INSIDE) == capsule.digest


def permits(capsule: Capsule) -> str:
    """The message if the capsule has source that was not permitted; empty if it has none, or if it was."""
    if capsule.sources is None or is_inside(capsule):
        return ""
    named = ", ".join(file.file for file in capsule.sources.files[:5])
    return (
        f". The capsule contains the source of components ({named}), which is code: nothing of it was executed; for a "
        "file that you trust, --allow-code permits it"
    )


def refuse_unused(path: str, capsule: Capsule) -> None:
    """Refuse a capsule that the process evaluates by something else than the source in it."""
    from worker.running.runs.own_sources import added

    if not is_inside(capsule):
        return
    assert capsule.sources is not None
    used = added(capsule.specification)
    if used is None or set(used[0].files) != set(capsule.sources.files):
        raise WrongInputError(
            f"{path} cannot be replayed: its campaign is not evaluated by exactly the source in it; without "
            "--allow-code the components of this installation evaluate it",
            RefusalCode.UNUSED_SOURCE,
        )


def opened_capsule(path: Path) -> tuple[Capsule, Mapping[str, bytes]]:
    """A capsule, and the texts of the source in it by module. Raises `WrongInputError`."""
    from campaigns.capsules.packing import CapsuleError, read

    try:
        capsule, _, texts = read(path)
    except CapsuleError as error:
        raise WrongInputError(
            f"{path} is not a capsule that can be replayed: {error}", RefusalCode.NO_CAPSULE
        ) from None
    return capsule, texts


def replayed_with_its_code(path: Path, arguments: Sequence[str]) -> int | None:
    """The exit code of the replay in that process; None if the capsule has no source, or if this is that process."""
    capsule, texts = opened_capsule(path)
    if capsule.sources is None or is_inside(capsule):
        return None
    _refuse_others(path, capsule, texts)
    with TemporaryDirectory(prefix="clearance-capsule-") as folder:
        environment = _written(Path(folder), capsule.sources, texts) | {INSIDE: capsule.digest}
        command = [sys.executable, "-P", "-m", "clearance", "replay", *arguments]
        ended = subprocess.run(
            command, env={**os.environ, **environment}, stdin=subprocess.DEVNULL, capture_output=True, check=False
        )
    typer.echo(ended.stdout.decode(errors="replace"), nl=False)
    typer.echo(ended.stderr.decode(errors="replace"), nl=False, err=True)
    return ended.returncode


def _refuse_others(path: Path, capsule: Capsule, texts: Mapping[str, bytes]) -> None:
    """Refuse source that is not that of the run, by the digests that the run recorded."""
    from worker.running.runs.meaning import meaning

    assert capsule.sources is not None
    for file in capsule.sources.files:
        recorded = capsule.versions.components if file.own else capsule.modules
        if not file.own and not recorded:
            continue
        if recorded.get(file.file if file.own else file.module) != meaning(texts[file.module]).digest:
            raise WrongInputError(
                f"{path} cannot be replayed: the text of {file.file} in it is not the one that the run recorded, so it "
                "was changed",
                RefusalCode.OTHER_SOURCE,
            )


def _written(folder: Path, sources: Sources, texts: Mapping[str, bytes]) -> dict[str, str]:
    """Write the files; the settings by which a process finds them."""
    from worker.engine.components.own import FOLDERS

    own, packages = folder / "own", folder / "packages"
    for place in (own, packages):
        place.mkdir()
    for file in sources.files:
        place = (own if file.own else packages) / file.file
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_bytes(texts[file.module])
    for entry in sources.entries:
        info = packages / f"{entry.distribution}-{entry.version}.dist-info"
        info.mkdir(exist_ok=True)
        described = f"Metadata-Version: 2.1\nName: {entry.distribution}\nVersion: {entry.version}\n"
        (info / "METADATA").write_text(described, encoding="utf-8")
        with (info / "entry_points.txt").open("a", encoding="utf-8") as file_of_entries:
            file_of_entries.write(f"[{entry.group}]\n{entry.name} = {entry.value}\n")
    root = str(Path(__file__).parents[2])
    paths = {
        FOLDERS: [str(own), os.environ.get(FOLDERS, "")],
        "PYTHONPATH": [str(packages), os.environ.get("PYTHONPATH", ""), root],
    }
    return {name: os.pathsep.join(filter(None, found)) for name, found in paths.items()}
