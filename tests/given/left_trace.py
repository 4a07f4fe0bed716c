"""What the source of a capsule executes when it is imported, so that a test notices it."""

from __future__ import annotations

import os
from pathlib import Path


def leave() -> None:
    """Leave the file that the test expects."""
    Path(os.environ["TRACE"]).touch()
