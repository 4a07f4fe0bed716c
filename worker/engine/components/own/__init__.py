"""The operator's own components: the files in the folders that CLEARANCE_COMPONENTS lists, as modules of this package.

A file `my_robot.py` of such a folder is the module `worker.engine.components.own.my_robot`; a file whose name begins
with _ is not a component, but components may import it: `from ._shared import drag`. `worker.running.catalogue.own`
finds the files.
"""

from __future__ import annotations

import os
from pathlib import Path

FOLDERS = "CLEARANCE_COMPONENTS"
TIMEOUT = "CLEARANCE_EXAMINATION_TIMEOUT"
"""Of the time for examining a file [s]."""
BUSY = f"if the machine was busy, try again or allow more time with {TIMEOUT}"


def listed() -> list[Path]:
    """The folders that the operator lists."""
    folders = (Path(each).expanduser().absolute() for each in os.environ.get(FOLDERS, "").split(os.pathsep) if each)
    return list(dict.fromkeys(folders))


def folders() -> list[Path]:
    """The folders of the setting that exist; of two files of the same name the first one counts."""
    return [folder for folder in listed() if folder.is_dir()]


__path__ = [str(folder) for folder in folders()]
