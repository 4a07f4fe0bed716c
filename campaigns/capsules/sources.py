"""The source of components that are not shipped: of the operator's folders and of other packages. It is code.

Nothing here executes it. A run stores it when it begins, and capsules contain it.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

_OWN = re.compile(r"worker\.(engine\.)?components\.own\.(?P<stem>.+)")
"""The modules that are files of the operator's folders, by their name of today and by that of earlier versions."""
MOST_FILES, LARGEST, LARGEST_OF_ALL = 60, 2 * 2**20, 8 * 2**20
"""Of the sources of a run: number of files, and size of each and of all [bytes]."""

_MODULE = r"[A-Za-z_][A-Za-z0-9_]{0,99}(\.[A-Za-z_][A-Za-z0-9_]{0,99}){0,9}"
_WORD = r"[A-Za-z0-9][A-Za-z0-9._+!-]{0,99}"
_OURS = re.compile(r"(worker|campaigns|backend|clearance)(\..*)?")

Module = Annotated[str, Field(pattern=f"^{_MODULE}$", max_length=200)]
Word = Annotated[str, Field(pattern=f"^{_WORD}$")]


class Part(BaseModel):
    """A part of a document; unknown keys are refused, so that nothing unread can be taken for evidence."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class SourceFile(Part):
    """One module; its text is apart."""

    module: Module
    package: bool
    """Whether it is the `__init__.py` of a package."""
    digest: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
    """SHA-256 of its text."""

    @property
    def own(self) -> bool:
        """Whether it is a file of the operator's folders."""
        return _OWN.fullmatch(self.module) is not None

    @property
    def file(self) -> str:
        """The path below its folder: my_robot.py, acme/robots/__init__.py."""
        if own := _OWN.fullmatch(self.module):
            return f"{own['stem']}.py"
        path = self.module.replace(".", "/")
        return f"{path}/__init__.py" if self.package else f"{path}.py"


class EntryPoint(Part):
    """By which a package adds a component or a method."""

    distribution: Word
    version: Word
    group: Annotated[str, Field(pattern=r"^clearance\.(components|methods)$")]
    name: Word
    value: Annotated[str, Field(pattern=rf"^{_MODULE}(:[A-Za-z_][A-Za-z0-9_.]*)?$", max_length=300)]


class Sources(Part):
    """The files of a run, without their texts."""

    files: Annotated[tuple[SourceFile, ...], Field(max_length=MOST_FILES)]
    entries: Annotated[tuple[EntryPoint, ...], Field(max_length=MOST_FILES)] = ()

    def faults(self, texts: Mapping[str, bytes]) -> str:
        """What is wrong with the sources or their texts by module, as a clause; empty if nothing is."""
        modules = [file.module for file in self.files]
        if sorted(texts) != sorted(modules):
            return "its sources are not those that it states"
        if sum(map(len, texts.values())) > LARGEST_OF_ALL:
            return f"its sources are larger than {LARGEST_OF_ALL // 2**20} MiB"
        for file in self.files:
            if hashlib.sha256(texts[file.module]).hexdigest() != file.digest:
                return f"the text of {file.file} in it was changed"
            own = _OWN.fullmatch(file.module)
            if (own and "." in own["stem"]) or (_OURS.fullmatch(file.module) and not own):
                return f"{file.module} in it is no component of the operator or of another package"
        return ""
