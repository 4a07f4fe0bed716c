"""What reads state outside of a function, by name: files, environment, clock, random numbers, processes, network.

Whether code has such a name is read from its text (`external`), from its compiled code (`uses`), and from an imported
component (`worker.running.examination.purity`). Only the standard library is imported.
"""

from __future__ import annotations

import re
from enum import StrEnum


class Outside(StrEnum):
    """What is read; the value is a clause on it, with the name that reads it."""

    FILES = "what {} reads from files"
    ENVIRONMENT = "what {} reads of its environment"
    CLOCK = "the clock that {} reads"
    RANDOM = "the random numbers of {}"
    PROCESSES = "the process that {} starts"
    NETWORK = "what {} reads from the network"
    ADDRESS = "what {} gives in this process"
    VALUE = "the module {} as a value"

    def clause(self, name: str) -> str:
        """A noun with what reads it."""
        return self.value.format(name)


FILES, ENVIRONMENT, CLOCK, RANDOM = Outside.FILES, Outside.ENVIRONMENT, Outside.CLOCK, Outside.RANDOM
PROCESSES, NETWORK, ADDRESS = Outside.PROCESSES, Outside.NETWORK, Outside.ADDRESS


def _each(kind: Outside | None, names: str) -> dict[str, Outside | None]:
    return dict.fromkeys(names.split(), kind)


NAMES: dict[str, Outside | None] = {
    **_each(RANDOM, "random secrets uuid numpy.random"),
    **_each(None, "uuid.UUID uuid.uuid3 uuid.uuid5 numpy.random.Generator"),
    **_each(CLOCK, "time datetime.datetime.now datetime.datetime.today datetime.datetime.utcnow datetime.date.today"),
    **_each(None, "time.sleep time.struct_time"),
    **_each(
        ENVIRONMENT,
        "os sys.argv sys.orig_argv sys.stdin sys.modules sys.getrefcount platform locale getpass pwd resource",
    ),
    **_each(ENVIRONMENT, "os.path.expanduser os.path.expandvars pathlib.Path.cwd pathlib.Path.home"),
    **_each(
        None,
        "os._exit os.abort os.kill os.path os.sep os.fspath os.linesep os.pathsep os.PathLike os.curdir os.pardir "
        "os.makedirs os.mkdir",
    ),
    **_each(PROCESSES, "os.system os.popen os.fork os.startfile subprocess multiprocessing pty"),
    **_each(FILES, "os.listdir os.scandir os.walk os.stat os.lstat os.open os.read os.access os.readlink"),
    **_each(FILES, "os.path.exists os.path.lexists os.path.isfile os.path.isdir os.path.getsize os.path.getmtime"),
    **_each(FILES, "io.open io.FileIO io.open_code sqlite3 shelve dbm mmap glob shutil tempfile fileinput linecache"),
    **_each(FILES, "configparser importlib.resources pkgutil.get_data netrc mailbox h5py netCDF4 zarr tables"),
    **_each(FILES, "scipy.datasets sklearn.datasets statsmodels.datasets"),
    **_each(NETWORK, "socket socketserver urllib.request http.client ftplib smtplib poplib imaplib xmlrpc requests"),
    **_each(NETWORK, "httpx urllib3 aiohttp websocket websockets paramiko zmq boto3"),
}
"""By the longest name that begins it; None for what reads nothing although the rest of its module does."""

BUILTINS: dict[str, Outside] = {
    "open": FILES,
    "input": ENVIRONMENT,
    "id": ADDRESS,
    "hash": ADDRESS,
    "__builtins__": FILES,
}

SEEDED = frozenset(
    _each(
        RANDOM,
        "random.Random numpy.random.default_rng numpy.random.RandomState numpy.random.SeedSequence numpy.random.PCG64 "
        "numpy.random.PCG64DXSM numpy.random.MT19937 numpy.random.Philox numpy.random.SFC64",
    )
)
"""Generators of random numbers that read nothing if they are given a seed."""

READING = re.compile(
    r"read|readfile|(read|scan)_\w+|imread|load|load(_\w+|txt|mat)|open|open_\w+|from_?(file|regex)|genfromtxt|memmap|DataSource|get_data"
    r"|(fetch|download|urlretrieve)\w*|\w*[a-z0-9](File|Reader)|Dataset|connect|urlopen"
)
"""Functions and classes of installed packages that read files, as far as their names tell."""

METHODS: dict[str, Outside | None] = {
    **_each(FILES, "read_text read_bytes iterdir rglob glob is_file is_dir exists stat open read_csv"),
    **_each(CLOCK, "now today utcnow"),
    **_each(NETWORK, "recv urlopen"),
    **_each(RANDOM, "rvs"),
}
"""Methods of whatever object: of paths, archives, dates, distributions."""

PLAIN = {"posix": "os", "posixpath": "os.path", "nt": "os", "ntpath": "os.path"}


def public(module: str, name: str) -> str:
    """The full name of an object by its module and its name there, without the private modules in between."""
    parts = [PLAIN.get(module, module.lstrip("_")), *name.split(".")]
    inner = [part for part in ".".join(parts).split(".") if not part.startswith("_") and part != "mtrand"]
    found = ".".join(inner)
    generator = f"numpy.random.{inner[-1]}" if inner else ""  # of a bit generator's own module
    return generator if found.startswith("numpy.random.") and generator in SEEDED else found


def outside(dotted: str) -> Outside | None:
    """What a name of an installed package reads, by its module and its name there; None if nothing."""
    top, _, rest = dotted.partition(".")
    top = PLAIN.get(top, top.lstrip("_"))
    parts = [*top.split("."), *filter(None, rest.split("."))]
    for count in range(len(parts), 0, -1):
        name = ".".join(parts[:count])
        if name in NAMES:
            return NAMES[name]
    last = parts[-1]
    if len(parts) == 1:
        return None
    return FILES if READING.fullmatch(last) else METHODS.get(last)
