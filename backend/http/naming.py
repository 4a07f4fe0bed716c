"""The names under which browsers save files of a run."""

from __future__ import annotations

import re
import unicodedata
import urllib.parse


def named(run: str, name: str, file: str) -> str:
    """R-0001-unicycle-past-a-pillar-run.json: only letters and digits of any script and dashes, for any run name."""
    known = unicodedata.normalize("NFC", name.lower())
    # M: accents and vowel signs that have no letter of their own.
    slug = "".join(c if unicodedata.category(c)[0] in "LMN" else "-" for c in known)
    slug = re.sub("-+", "-", slug)[:48].strip("-")
    return "-".join(part for part in (run, slug, file) if part)


def disposition(how: str, name: str) -> str:
    """The header Content-Disposition (RFC 6266) of a name: in ASCII, and next to it as it is (RFC 8187)."""
    plain = re.sub("-+", "-", unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode())
    plain = re.sub(r"[^\w.-]", "", plain)
    whole = "" if plain == name else f"; filename*=UTF-8''{urllib.parse.quote(name, safe='')}"
    return f'{how}; filename="{plain}"{whole}'
