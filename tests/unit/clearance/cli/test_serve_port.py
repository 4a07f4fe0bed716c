"""The port of `clearance serve`: from the moment it is chosen, only the backend can listen on it."""

from __future__ import annotations

import socket
from pathlib import Path

import pytest

from backend.__main__ import _listen
from backend.settings import Settings
from clearance.cli.serve import _reserved


def test_a_port_that_is_chosen_is_taken_by_nobody_before_the_backend_listens(tmp_path: Path) -> None:
    with _reserved("127.0.0.1", 0) as reserved:
        address = reserved.getsockname()
        with socket.socket() as other, pytest.raises(OSError, match="in use"):
            other.bind(address)
        with _listen(Settings(data=tmp_path, port=address[1])) as listening, socket.create_connection(address):
            listening.accept()[0].close()
        with _listen(Settings(data=tmp_path, port=address[1])):
            pass  # a backend that is restarted
