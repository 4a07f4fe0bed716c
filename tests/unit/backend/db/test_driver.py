"""A database whose driver is not installed."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from backend.db.engine import connect
from clearance.cli import WRONG_INPUT, invoke

SERVER = "postgresql://user:secret@nowhere/clearance"


def test_it_is_refused_with_the_package_that_is_missing(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setitem(sys.modules, "psycopg", None)
    with pytest.raises(ValueError, match=r"psycopg\[binary\]"):
        connect(SERVER)
    monkeypatch.chdir(tmp_path)
    for words in (["worker"], ["serve", "--port", "0"], ["token", "list"]):
        assert invoke([*words, "--database", SERVER]) == WRONG_INPUT, words
        said = capsys.readouterr().err
        assert "psycopg[binary]" in said
        assert "secret" not in said
