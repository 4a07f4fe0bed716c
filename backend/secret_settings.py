"""Secrets of the settings: each from its variable, or from the file that the variable with `_FILE` at its end names.

One place for the service and the command line. Files keep secrets out of the environment, which `docker inspect` shows.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

import sqlalchemy as sa

FILE = "_FILE"
LONGEST = 65536
"""Largest content of a file [characters]."""
DATABASE, PASSWORD = "CLEARANCE_DATABASE", "CLEARANCE_DATABASE_PASSWORD"
WHOLE = dict.fromkeys((DATABASE + FILE, PASSWORD, PASSWORD + FILE), "")
"""What is emptied for a process that is given the whole URL of the database."""


def read(names: Iterable[str], environment: Mapping[str, str]) -> dict[str, str]:
    """The environment, with the contents of the files that are given for these variables. Raises `ValueError`."""
    found = dict(environment)
    for name in names:
        file = found.pop(name + FILE, "")
        if file and found.get(name):
            raise ValueError(f"{name} and {name}{FILE} are both given: leave one of them out")
        if file:
            found[name] = _content(name + FILE, Path(file))
    return found


def database(option_url: str, environment: Mapping[str, str]) -> str:
    """The database's URL for the command line; option_url: that of the option or its variable. Raises `ValueError`."""
    by_option = bool(option_url) and option_url != environment.get(DATABASE)
    found = read([PASSWORD] if by_option else [DATABASE, PASSWORD], environment)
    return with_password(option_url if by_option else found.get(DATABASE, ""), found.get(PASSWORD, ""))


def with_password(url: str, password: str) -> str:
    """The URL with the password that is given apart from it, if any. Raises `ValueError` where it has no place."""
    if not password:
        return url
    try:
        parsed = sa.make_url(url)
    except sa.exc.ArgumentError:
        parsed = None
    if parsed is None or not parsed.drivername.startswith("postgres"):
        raise ValueError(f"{PASSWORD} is given, and the database is not like postgresql://user@host/name: give both")
    if parsed.password:
        raise ValueError(f"{DATABASE} has a password, and {PASSWORD} is given, too: leave one of them out")
    return parsed.set(password=password).render_as_string(hide_password=False)


def _content(variable: str, file: Path) -> str:
    try:
        text = file.read_text(encoding="utf-8").strip()
    except (OSError, UnicodeError) as error:
        raise ValueError(f"{variable} cannot be read by the user of this process: {error}") from None
    if not text or len(text) > LONGEST:
        raise ValueError(f"{variable} must contain 1 to {LONGEST} characters, and {file} has {len(text)}")
    return text
