"""`python -P -m backend.requirements.reading`: reads an uploaded file in a process of its own, within limits.

Standard input is a line of JSON with kind and names of attributes, then the file; standard output the requirements as
JSON, or the reason why the file is refused. The process holds no secrets and ends with the file. Started by
`backend.requirements.uploads`.
"""

from __future__ import annotations

import json
import resource
import sys

from backend.requirements import reqif
from backend.requirements.reqif import CannotRead, Read

MEMORY = 512 * 2**20
"""Address space [bytes]; a file of 8 MB with as many elements as are allowed takes 200 MB."""
SECONDS = 10
"""Processor time [s]; such a file takes 2 s."""
MOST = 20_000
"""Requirements of a file."""
MOST_ATTRIBUTES, LONGEST_ATTRIBUTE = 60, 2000
"""Of a requirement; the rest is in its file only."""
LARGEST = 16_000_000
"""Maximum size of what is read [bytes]."""


def main() -> None:
    """Read one file. The limits hold before its first byte is read."""
    for limited, value in ((resource.RLIMIT_AS, MEMORY), (resource.RLIMIT_CPU, SECONDS), (resource.RLIMIT_CORE, 0)):
        hard = resource.getrlimit(limited)[1]
        lower = value if hard == resource.RLIM_INFINITY else min(value, hard)
        resource.setrlimit(limited, (lower, lower))
    request = json.loads(sys.stdin.buffer.readline())
    try:
        made = read(request["kind"], sys.stdin.buffer.read(), request["id"], request["text"])
    except CannotRead as error:
        made = json.dumps({"refused": str(error)})
    sys.stdout.write(made)


def read(kind: str, content: bytes, id_name: str, text_name: str) -> str:
    """The requirements of a file as JSON; raises `CannotRead` with a sentence."""
    found, skipped = reqif.read(content, id_name, text_name) if kind == "reqif" else _csv(content, id_name, text_name)
    if len(found) > MOST:
        raise CannotRead(f"{len(found):,} requirements are too many: at most {MOST:,}")
    made = json.dumps({"found": [(one.id, one.text, _cut(one.attributes)) for one in found], "skipped": skipped})
    if len(made) > LARGEST:
        raise CannotRead(f"the file has more than {LARGEST:,} bytes of texts and attributes: export fewer at a time")
    return made


def _csv(content: bytes, id_name: str, text_name: str) -> tuple[list[Read], int]:
    from backend.requirements import table  # loads more, which ReqIF does not need

    return table.read(content, id_name, text_name)


def _cut(attributes: dict[str, str]) -> dict[str, str]:
    """The attributes as far as the page shows them; null characters cannot be stored."""
    some = list(attributes.items())[:MOST_ATTRIBUTES]
    return {key[:200].replace("\0", ""): value[:LONGEST_ATTRIBUTE].replace("\0", "") for key, value in some}


if __name__ == "__main__":
    main()
