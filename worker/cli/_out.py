"""The folder that a command is to write its results into."""

from __future__ import annotations

from pathlib import Path

from worker.cli import WrongInputError


def writable(out: Path | None) -> None:
    """Make the folder; raises `WrongInputError` where nothing can be written into it."""
    if out is None:
        return
    try:
        out.mkdir(parents=True, exist_ok=True)
        probe = out / ".writable"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise WrongInputError(f"the folder {out} cannot be written: {error.strerror}") from None
