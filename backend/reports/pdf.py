"""Prints HTML to PDF with this machine's Chromium, if it is installed.

Headless, with a temporary profile. The page's content security policy blocks scripts; the browser's own switch against
scripts would also disable printing.
"""

from __future__ import annotations

import contextlib
import logging
import os
import shutil
import signal
import subprocess
import tempfile
from pathlib import Path

from backend.http.errors import RefusedError, no_temporary_file

NAMES = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
"""The first has no windows, tabs and toolbars, which take a quarter of the processor time of the others."""
PATIENCE = 60.0
"""Time limit of a print job [s]."""

MISSING = (
    "Chromium, which prints the PDF, was not found on this machine: install it (on Debian: `apt install chromium`), or "
    "open the report as HTML and print it from any browser"
)

_log = logging.getLogger(__name__)


def browser() -> str | None:
    return next((found for name in NAMES if (found := shutil.which(name))), None)


def printed(html: str, sandbox: bool = True) -> bytes:
    """The page as PDF; sandbox: whether the browser makes its own. Raises 503 if there is no browser or it fails."""
    path = browser()
    if path is None:
        raise RefusedError("no-browser", MISSING)
    try:
        folder = tempfile.TemporaryDirectory(prefix="clearance-pdf-", ignore_cleanup_errors=True)
        source = Path(folder.name) / "report.html"
        source.write_text(html, encoding="utf-8")
    except OSError as error:
        raise no_temporary_file(error) from None
    with folder:
        return _print(path, source, Path(folder.name), sandbox)


def _print(path: str, source: Path, folder: Path, sandbox: bool) -> bytes:
    target = folder / "report.pdf"
    output = _run([path, *_arguments(folder, target, sandbox), source.as_uri()], folder)
    if output is not None or not target.is_file():
        _log.error("printing a report failed: %s", output)
        why = "it took too long" if output == "" else "it ended without writing a file; see the service's log"
        raise RefusedError("browser-failed", f"Chromium could not print the report: {why}. Print the HTML instead")
    return target.read_bytes()


def _arguments(folder: Path, target: Path, sandbox: bool) -> list[str]:
    # Chromium has no sandbox when run by root; the page is generated here and its policy blocks scripts.
    root = hasattr(os, "geteuid") and os.geteuid() == 0
    return [
        "--headless",
        *(["--no-sandbox"] if root or not sandbox else []),
        "--disable-gpu",
        "--disable-extensions",
        "--disable-background-networking",
        "--disable-component-update",
        "--disable-sync",
        "--disable-dev-shm-usage",
        "--no-first-run",
        f"--user-data-dir={folder / 'profile'}",
        "--no-pdf-header-footer",
        f"--print-to-pdf={target}",
    ]


def _run(command: list[str], folder: Path) -> str | None:
    """Run the browser: None on success, empty after a timeout, else its error output. All its processes are ended."""
    environment = {**os.environ, "HOME": str(folder), "TMPDIR": str(folder), "XDG_CONFIG_HOME": str(folder)}
    with (folder / "output.txt").open("w+b") as output:
        process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=output, stderr=output, env=environment, start_new_session=True
        )
        try:
            code: int | None = process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            code = None
        finally:
            _end(process)
        output.seek(0)
        words = output.read()[-2000:].decode(errors="replace")
    if code is None:
        return ""
    return None if code == 0 else words or f"exit code {code}"


def _end(process: subprocess.Popen[bytes]) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()
