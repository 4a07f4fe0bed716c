"""How long compilations took on this machine, and callbacks for the time while one runs."""

from __future__ import annotations

import contextlib
import re
import socket
import statistics
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Self

Begun = Callable[[float | None], None]
Ended = Callable[[], None]

_DIGEST = re.compile(r"_[0-9a-f]{16}$")
_UNSAFE = re.compile(r"[^\w.-]")
_reported: list[tuple[Begun, Ended]] = []


@contextmanager
def reported(begun: Begun, ended: Ended) -> Iterator[None]:
    """Within the block, `begun` is called when a compilation begins, with its expected duration [s] if it is known, and
    `ended` when it has ended. A function that is loaded from the disk cache is not reported."""
    pair = (begun, ended)
    _reported.append(pair)
    try:
        yield
    finally:
        _reported.remove(pair)


class Watched:
    """A context around the first call of one function: it is loaded from the disk cache, compiled here, or by another
    process.

    Durations are stored per machine, because a cache folder may be shared by several.
    """

    def __init__(self, function: Callable[..., object], cache: Path) -> None:
        name = f"{function.__module__}.{function.__qualname__}"
        self._name = _UNSAFE.sub("_", _DIGEST.sub("", name))[:200]
        self._folder = cache / "seconds" / _UNSAFE.sub("_", socket.gethostname())
        self._compiling: float | None = None
        self._listeners: list[tuple[Begun, Ended]] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, error: object, *further: object) -> None:
        """The function can be called, or could not be compiled."""
        if self._compiling is not None and error is None:
            self._store(time.monotonic() - self._compiling)
        for _, ended in self._listeners:
            ended()

    def wait(self) -> None:
        """Report that another process compiles it."""
        if not self._listeners:
            self._listeners = list(_reported)
            expected = self.expected() if self._listeners else None
            for begun, _ in self._listeners:
                begun(expected)

    def compile(self) -> None:
        """Note that the loop is compiled here from now on."""
        self._compiling = time.monotonic()
        self.wait()

    def expected(self) -> float | None:
        """How long the last compilation took [s], else the median of others from the same template; None if unknown."""
        own = _read(self._folder / self._name)
        if own is not None:
            return own
        template = "_".join(self._name.split("_")[-2:])  # fly_8, of whichever vehicle
        others = [_read(file) for file in self._folder.glob(f"*_{template}")]
        known = [seconds for seconds in others if seconds is not None]
        return statistics.median(known) if known else None

    def _store(self, seconds: float) -> None:
        with contextlib.suppress(OSError):  # an estimate is missing then, nothing else
            self._folder.mkdir(parents=True, exist_ok=True)
            (self._folder / self._name).write_text(f"{seconds:.3f}\n")


def _read(file: Path) -> float | None:
    try:
        seconds = float(file.read_text())
    except (OSError, ValueError):
        return None
    return seconds if 0.0 < seconds < 3600.0 else None
