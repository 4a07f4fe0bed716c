"""Builds the stages of a Dockerfile in folders: its own instructions, on bases that are given.

It knows the instructions that the Dockerfile of this project uses; any other one is an error.
"""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from tests.faults.image.rooted import PATH, rooted

VARIABLE = re.compile(r"\$(?:\{(\w+)\}|(\w+))")


@dataclass
class Stage:
    """The files of a stage, and what it says about containers."""

    root: Path
    folder: str = "/"
    environment: dict[str, str] = field(default_factory=lambda: {"PATH": PATH})
    user: str = "0:0"
    command: list[str] = field(default_factory=list)


def instructions(text: str) -> Iterator[tuple[str, str]]:
    """Name and rest of each instruction, without comments, on one line."""
    lines = [line for line in text.splitlines() if not line.lstrip().startswith("#")]
    for line in re.sub(r"\\\n\s*", "", "\n".join(lines)).splitlines():
        if line.strip():
            name, _, rest = line.strip().partition(" ")
            yield name, rest.strip()


class Build:
    """A build: bases by the name of their image, the context, and a folder for the stages."""

    def __init__(self, context: Path, bases: Mapping[str, Path], into: Path) -> None:
        self.context, self.bases, self.into = context, bases, into
        self.arguments: dict[str, str] = {}
        self.stages: dict[str, Stage] = {}
        self.stage = Stage(context)

    def run(self, text: str) -> Stage:
        """Perform all instructions; returns the last stage."""
        for name, rest in instructions(text):
            step = getattr(self, f"_{name.lower()}", None)
            if step is None:
                raise ValueError(f"the Dockerfile has the instruction {name}, which this test does not know: add it")
            step(rest)
        return self.stage

    def _arg(self, rest: str) -> None:
        name, _, value = rest.partition("=")
        self.arguments[name] = value

    def _from(self, rest: str) -> None:
        of, _, name = self._filled(rest, self.arguments).partition(" AS ")
        root = self.into / (name or "last")
        before = self.stages.get(of)
        files = before.root if before else self.bases[of.partition(":")[0]]
        subprocess.run(["cp", "-a", files, root], check=True)
        self.stage = Stage(root) if before is None else Stage(root, before.folder, dict(before.environment))
        self.stages[name or "last"] = self.stage

    def _workdir(self, rest: str) -> None:
        self.stage.folder = rest
        self._at(rest).mkdir(parents=True, exist_ok=True)

    def _copy(self, rest: str) -> None:
        *sources, target = rest.split()
        origin = self.context
        if sources[0].startswith("--from="):
            origin = self.stages[sources.pop(0).removeprefix("--from=")].root
        if any(source.startswith("--") for source in sources):
            raise ValueError(f"the Dockerfile has COPY {rest}, whose option this test does not know: add it")
        for source in sources:
            _copied(origin / source.lstrip("/"), self._at(target), target.endswith("/"))

    def _run(self, rest: str) -> None:
        rooted(self.stage.root, rest, self.stage.folder, self.stage.environment)

    def _env(self, rest: str) -> None:
        for each in rest.split():
            name, _, value = each.partition("=")
            self.stage.environment[name] = self._filled(value, self.stage.environment)

    def _user(self, rest: str) -> None:
        self.stage.user = rest

    def _cmd(self, rest: str) -> None:
        self.stage.command = json.loads(rest)

    def _volume(self, rest: str) -> None:
        if not self._at(rest).is_dir():
            raise ValueError(f"VOLUME {rest} is no folder of the image, so that its owner is root")

    def _expose(self, rest: str) -> None:
        int(rest)

    def _at(self, path: str) -> Path:
        """A path of the image, from its working folder, in the files of the stage."""
        return self.stage.root / (Path(self.stage.folder) / path).relative_to("/")

    def _filled(self, text: str, values: Mapping[str, str]) -> str:
        return VARIABLE.sub(lambda found: values[found[1] or found[2]], text)


def _copied(source: Path, target: Path, into: bool) -> None:
    """A folder's content goes into the target; a file becomes the target, or goes into it."""
    if source.is_dir():
        shutil.copytree(source, target, symlinks=True, dirs_exist_ok=True)
        return
    file = target / source.name if into or target.is_dir() else target
    file.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy2(source, file)
