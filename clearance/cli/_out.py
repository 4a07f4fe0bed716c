"""The folder for a command's results."""

from __future__ import annotations

from pathlib import Path

from clearance.cli import WrongInputError


def writable(out: Path | None) -> None:
    """Make the folder; raises `WrongInputError` if it is not writable."""
    if out is None:
        return
    try:
        out.mkdir(parents=True, exist_ok=True)
        probe = out / ".writable"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise WrongInputError(f"the folder {out} cannot be written: {error.strerror}") from None
