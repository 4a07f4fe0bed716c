"""What `make check` leaves out is named by hand: every name is that of a file or a test that exists."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[3]


def left_out(script: str, name: str) -> list[str]:
    """The entries of an array of the script."""
    found = re.search(rf"^{name}=\(\n(.*?)^\)$", script, re.MULTILINE | re.DOTALL)
    assert found is not None
    return found[1].split()


def absent(script: str, root: Path) -> Iterator[str]:
    """What it leaves out and does not exist: pytest does not report it."""
    for entry in (*left_out(script, "SLOW"), *left_out(script, "STARTING")):
        file, _, test = entry.partition("::")
        text = (root / file).read_text(encoding="utf-8") if (root / file).is_file() else None
        if text is None or (test and f"def {test}(" not in text):
            yield entry


def test_what_the_check_leaves_out_exists() -> None:
    script = (ROOT / "tools" / "check.sh").read_text(encoding="utf-8")
    assert list(absent(script, ROOT)) == []
    assert (slow := left_out(script, "SLOW")) == sorted(set(slow))
    assert left_out(script, "STARTING")


def test_what_is_gone_is_refused(tmp_path: Path) -> None:
    (tmp_path / "test_here.py").write_text("\n\ndef test_a() -> None: ...\n")
    starting = "\n".join(f"    test_here.py::test_{name}" for name in "ab")
    script = f"SLOW=(\n    test_here.py\n    test_gone.py\n)\nSTARTING=(\n{starting}\n)\n"
    assert list(absent(script, tmp_path)) == ["test_gone.py", "test_here.py::test_b"]
