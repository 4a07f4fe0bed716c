"""The operating-system user, whom the audit trail names for what is done on the command line."""

from __future__ import annotations

import getpass


def operator() -> str:
    """The user's name; `unknown` where there is none, as in some containers."""
    try:
        return getpass.getuser()
    except (KeyError, OSError):
        return "unknown"
