"""What reading a damaged file of a run may raise: JSON, the arrays of numpy, and the zip file that holds them."""

from __future__ import annotations

import struct
import zipfile
import zlib

UNREADABLE: tuple[type[Exception], ...] = (
    *(OSError, EOFError, ValueError, LookupError, TypeError, AttributeError),
    *(zipfile.BadZipFile, zlib.error, struct.error, NotImplementedError),
    RuntimeError,  # deeply nested JSON, or an entry that is marked as encrypted
    MemoryError,  # an array whose head states another size
)
