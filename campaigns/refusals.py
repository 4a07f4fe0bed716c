"""Why a command refuses its input, as a code: it follows the message in brackets, so that a script can rely on it."""

from __future__ import annotations

from enum import StrEnum


class RefusalCode(StrEnum):
    """The codes of the commands' own refusals; a service's refusal has the kind of its problem document."""

    OTHER = ""
    """There is only the message."""
    CODE_NOT_PERMITTED = "code-not-permitted"
    EXISTS = "exists"
    NAME_TAKEN = "name-taken"
    NO_CAPSULE = "no-capsule"
    NO_DATABASE = "no-database"
    NO_FILE = "no-file"
    NO_RUN = "no-run"
    NO_SUCH_CASE = "no-such-case"
    NO_TRAIL = "no-trail"
    NO_VERDICT = "no-verdict"
    NOT_EVALUABLE = "not-evaluable"
    NOT_THERE = "not-there"
    """The campaign is evaluated here and nowhere else."""
    OPTIONS = "options"
    OTHER_CAMPAIGN = "other-campaign"
    OTHER_CODE = "other-code"
    OTHER_COMPONENTS = "other-components"
    OTHER_PLAN = "other-plan"
    OTHER_POINTS = "other-points"
    OTHER_SCHEMA = "other-schema"
    OTHER_SOURCE = "other-source"
    TOO_LITTLE_MEMORY = "too-little-memory"
    UNREADABLE = "unreadable"
    UNUSED_SOURCE = "unused-source"
    WOULD_LOSE = "would-lose"
    """An extension would not store what bars "cleared" in the run."""


class Refusal(Exception):
    """An input that is refused; the message states why and what to do."""

    def __init__(self, message: str, code: str = RefusalCode.OTHER) -> None:
        super().__init__(message)
        self.code = code
