"""What a refused command printed, without its words: the code of the refusal, the fields of a campaign's problems."""

from __future__ import annotations

import re

import pytest

from clearance.cli import WRONG_INPUT, invoke


def refusal(errors: str) -> str:
    """The code that follows the message of a command on standard error."""
    found = re.fullmatch(r"(?s)(?:.*\n)?Error: .* \[([a-z-]+)\]\n", errors)
    assert found is not None, errors
    return found[1]


def refused(capsys: pytest.CaptureFixture[str], *arguments: object) -> str:
    """The code with which a command refuses its arguments."""
    capsys.readouterr()
    assert invoke([str(argument) for argument in arguments]) == WRONG_INPUT
    return refusal(capsys.readouterr().err)


def fields(errors: str) -> list[str]:
    """The fields of the problems of a campaign that a command refused."""
    assert "cannot be used:\n" in errors, errors
    return re.findall(r"(?m)^  ([\w.]+): ", errors)
