"""A component that is random, keeps state or goes wrong after seconds is refused, in one sentence with its line."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest

from tests.given.at_night import nightly_but
from worker.engine.components import own as own_package
from worker.running.catalogue import own
from worker.running.catalogue.installed import components, source_of
from worker.running.examination import flying, purity, reading
from worker.running.examination.declaring import declared_by
from worker.running.examination.flying import flown
from worker.running.examination.mistake import Mistake

SKELETON = Path(__file__).parents[4] / "worker" / "running" / "skeletons" / "avoider.py"
GOAL = "    x, y = p.k_goal * (goal.x - q[0]), p.k_goal * (goal.y - q[1])\n"
TOP = "\n\nclass MyAvoider"


class Bad(NamedTuple):
    """What is wrong with an avoider: lines at its top, lines in `steer`, in which line it is found, the sentence."""

    what: str
    top: str
    steer: str
    at: str
    text: str


def term(what: str, top: str, text: str, sentence: str) -> Bad:
    """A number that is added to the demand."""
    return Bad(what, top, f"x = x + {text}", text, sentence)


def top(what: str, top: str, at: str, sentence: str, text: str = "K") -> Bad:
    """A mistake at the top, which `text` in `steer` uses."""
    return term(what, top, text, sentence)._replace(at=at)


COUNTED = "class Count:\n    n = 0.0\n\n\ndef counted():\n    Count.n = Count.n + 1.0\n    return Count.n"
IMPURE = [
    term("random.random", "import random", "random.random()", "uses random.random, which is random"),
    term("random under another name", "import random as r", "r.gauss(0.0, 1.0)", "uses r.gauss, which is random"),
    term("from random import", "from random import random as noise", "noise()", "uses noise, which is random"),
    term("a generator", "import random\nR = random.Random(1)", "R.random()", "uses R.random, which is random"),
    term("kept for later", "import random\nnoise = random.random", "noise()", "uses noise, which is random"),
    term("numpy.random", "import numpy as np", "np.random.normal()", "uses np.random.normal, which is random"),
    term("a generator of numpy", "import numpy as np\nG = np.random.default_rng(1)", "G.normal()", "which is random"),
    term("secrets", "import secrets", "secrets.randbelow(2)", "which is random"),
    term("time.time", "import time", "time.time()", "uses time.time, which reads the clock"),
    term("perf_counter", "from time import perf_counter as now", "now()", "uses now, which reads the clock"),
    term("datetime", "import datetime as d", "d.datetime.now().second", "which reads the clock"),
    term("print", "", "(print(x) or 0.0)", "uses print, which reaches outside of the simulation"),
    term("open", "", "(open('f') and 0.0)", "uses open, which reaches outside"),
    term("print under another name", "show = print", "(show(x) or 0.0)", "uses show, which reaches outside"),
    term("hash", "", "hash('a')", "uses hash, which differs between processes"),
    term("id", "", "float(id(p))", "uses id, which differs between processes"),
    term("the environment", "import os", "float(os.environ['A'])", "which reaches outside"),
    term("arguments of the program", "import sys", "len(sys.argv)", "uses sys.argv, which reaches outside"),
    term("a counter", "import itertools\nC = itertools.count()", "next(C)", "which reaches outside"),
    term("a deque", "import collections\nQ = collections.deque((1.0,))", "Q[0]", "reads Q, a deque, and kernels read"),
    term("an object", "class Count:\n    n = 0.0\n\n\nC = Count()", "C.n", "reads C.n, a Count, and kernels read"),
    term("a list in a tuple", "T = ([1.0],)", "T[0][0]", "reads T, a tuple, and kernels read constants only"),
    term("a list", "LAST = [0.0]", "LAST[0]", "reads LAST, a list (line 19), and kernels read constants only"),
    term("a dict", "LAST = {'x': 0.0}", "LAST['x']", "reads LAST, a dict (line 19), and kernels read"),
    term("a name that changes", "N = 0.0\nN = 1.0", "N", "reads N, which is assigned more than once"),
    term("a helper", "from ._shared import noise", "noise()", "_shared.py, line 6: noise uses random.random, which is"),
    Bad("global", "N = 0.0", "global N", "global N", "contains `global`"),
    Bad("an array", "import numpy as np\nA = np.zeros(1)", "A[0] = 1.0", "A[0] =", "changes A, and a kernel cannot"),
    Bad("a random constant", "import random\nK = random.random()", "", "K =", "random.random is random"),
    Bad("a loop that may not end", "", "while x != -1.5:\n        y = y + 1.0", "while x", "`while` without a bound"),
    Bad(
        "a loop that does not end for other parameters",
        "",
        "while p.k_goal > 1e3 and y > 0.0:\n        y = y + 1.0",
        "while p.k",
        "`while` without a bound",
    ),
    Bad(
        "a loop with a way out",
        "",
        "while True:\n        y = y + 1.0\n        if y > 9.0:\n            break",
        "while True",
        "`while` without a bound",
    ),
    Bad(
        "a loop that counts another way",
        "",
        "n = 0\n    while n < 9:\n        n -= 1",
        "while n",
        "`while` without a bound",
    ),
    Bad(
        "a bound that moves",
        "",
        "n, m = 0, 9\n    while n < m:\n        n += 1\n        m += 1",
        "while n",
        "without a bound",
    ),
    top(
        "an array as default",
        "import numpy as np\n\n\n@kernel\ndef helper(x, memo=np.random.rand(1)):\n    return x",
        "memo=",
        "np.random.rand is random",
        "helper(x)",
    ),
    top(
        "a random default of a class",
        "import random\n\n\nclass D:\n    k = random.random()",
        "k = ",
        "is random",
        "D.k",
    ),
    top("an object's address", "K = float(len(repr(object())))", "K =", "differs between processes"),
    top("an object's hash", "K = float('a'.__hash__() % 7)", "K =", "__hash__ differs between processes"),
    top("the order of a set", "K = float([*{'a', 'b'}][0] == 'a')", "K =", "a set has another order in every process"),
    top(
        "the order of a frozenset",
        "K = float(list(frozenset('ab'))[0] == 'a')",
        "K =",
        "another order in every process",
    ),
    top("a distribution", "from scipy.stats import norm\nK = float(norm.rvs())", "K =", "norm.rvs is random"),
    top(
        "a table",
        "import numpy as np\nK = float(np.fromfile(__file__, dtype=np.uint8)[0])",
        "K =",
        "np.fromfile reads what the digest of",
    ),
    top(
        "a file",
        "from pathlib import Path\nK = float(len(Path(__file__).read_text()))",
        "K =",
        "read_text reads what the digest of the component",
    ),
    top(
        "the environment at the top",
        "import os\nK = float(os.environ.get('K', '1'))",
        "K =",
        "os.environ.get reads what",
    ),
    top(
        "a closure",
        "import numpy as np\n\n\ndef make():\n    @kernel\n    def drawn(t):\n        return "
        "np.random.random()\n\n    return drawn\n\n\ndrawn = make()",
        "return np.random",
        "uses np.random.random, which is",
        "drawn(t)",
    ),
    term("a generator expression", "G = (float(i) for i in range(9))", "G.send(None)", "reads G.send, a generator"),
    Bad(
        "objmode", "import numba", "with numba.objmode(y='float64'):\n        y = 1.0", "with numba", "contains `with`"
    ),
    Bad("a constant of the clock", "import time\nK = time.time()", "", "K =", "time.time reads the clock"),
]
"""Found by name."""

AT = "{} for {}, expected a finite number at t = {}"
SLOW = "the check stopped after 3 s in steer, while simulating"
LATER = [
    Bad("NaN after 5 s", "", "x = (1e400 - 1e400 if t > 5.0 else x)", "return (x, y)", AT.format("NaN", "x", 5)),
    Bad(
        "NaN after 20 s", "", "y = y * (1e400 - 1e400 if t > 20.0 else 1.0)", "return (x, y)", AT.format("NaN", "y", 20)
    ),
    Bad("infinite at once", "", "x = 1e400", "return (x, y)", AT.format("inf", "x", 0)),
    term("a division by zero after 5 s", "", "(1.0 / (t - t) if t > 5.0 else 0.0)", "a division by zero"),
    term("a division by zero far away", "", "(1.0 / (q[0] - q[0]) if q[0] > 5.0 else 0.0)", "a division by zero"),
    Bad("a root of a negative number", "", "x = (5.0 - t) ** 0.5", "return (x, y)", "a complex"),
    term("an index", "", "q[int(t)]", "an index beyond the end"),
    term("a name that is missing in one branch", "", "(p.missing if t > 5.0 else 0.0)", "MyAvoider has no 'missing'"),
    top(
        "an array as an argument",
        "import numpy as np\nA = np.zeros(1)\n\n\n@kernel\ndef helper(a):\n    a[0] += 1.0\n    return a[0]",
        "return a[0]",
        "gives another result when the same case is simulated again",
        "helper(A)",
    ),
    Bad(
        "an array by another name",
        "import numpy as np\nA = np.zeros(1)",
        "b = A\n    b[0] = b[0] + 1.0\n    x = x + b[0]",
        "return (x, y)",
        "gives another result when the same case is simulated again",
    ),
    top(
        "a closure that counts",
        "def make():\n    n = [0.0]\n\n    @kernel\n    def counted():\n        n[0] += 1.0\n"
        "        return n[0]\n\n    return counted\n\n\ncounted = make()",
        "return n[0]",
        "gives another result when",
        "counted()",
    ),
    Bad(
        "an object that counts",
        COUNTED,
        "x = x + counted()",
        "return Count.n",
        "counted gives another result when the same case is",
    ),
]
"""Found in simulations."""

TURNS = "for _ in range(int({})):\n        y = y + 1.0"
ENDLESS = [
    Bad("a loop in a kernel", "", TURNS.format("1e15"), "y = y + 1.0|for _ in range", SLOW),
    Bad("a loop after 5 s", "", TURNS.format("1e15 if t > 5.0 else 0.0"), "y = y + 1.0|for _ in range", SLOW),
    Bad(
        "a loop at the top",
        "while True:\n    pass",
        "",
        "pass|while True",
        "the check stopped after 3 s in a loop at the top of the file",
    ),
]
"""Found by the time that they take."""

TABLED = """import numpy as np
K = 1.0
def table():
    return float(np.fromfile(__file__, dtype=np.uint8)[0])
"""

SHARED = """import random
from worker.engine.kernels.maths import kernel

@kernel
def noise():
    return random.random()
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder whose files are modules of the package of own components."""
    monkeypatch.setattr(own_package, "__path__", [str(tmp_path)])
    monkeypatch.setenv("CLEARANCE_COMPONENTS", str(tmp_path))
    monkeypatch.setenv("CLEARANCE_KERNEL_CACHE", str(tmp_path / "cache"))
    (tmp_path / "_shared.py").write_text(SHARED, encoding="utf-8")
    (tmp_path / "_tabled.py").write_text(TABLED, encoding="utf-8")
    yield tmp_path
    for name in [name for name in sys.modules if name.startswith("worker.engine.components.own.")]:
        del sys.modules[name]
        vars(own_package).pop(name.rpartition(".")[2], None)


def written(folder: Path, bad: Bad) -> Path:
    text = SKELETON.read_text(encoding="utf-8")
    assert text.count(GOAL) == text.count(TOP) == 1, "the skeleton has changed"
    text = text.replace(TOP, f"\n{bad.top}{TOP}" if bad.top else TOP)
    text = text.replace(GOAL, f"{GOAL}    {bad.steer}\n" if bad.steer else GOAL)
    file = folder / "my_avoider.py"
    file.write_text(text, encoding="utf-8")
    return file


def reported(file: Path, bad: Bad, text: str, line: int) -> None:
    assert bad.text in text, f"line {line}: {text}"
    found = file.read_text(encoding="utf-8").splitlines()[line - 1]
    assert any(at in found for at in bad.at.split("|")), f"line {line}: {text}"
    assert len(text.split()) <= 60


def examined(file: Path) -> None:
    """All but the compiler."""
    source, module = reading.read(file), "worker.engine.components.own.my_avoider"
    reading.check(source)
    component = declared_by(source, module)
    purity.check(source, module)
    flown(component, source, lambda _: None)


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    """Simulations of three seconds instead of thirty, for what is the same in every step."""
    monkeypatch.setattr(flying, "LONG", 300)


@pytest.mark.by_day(20)
@pytest.mark.parametrize("bad", [*IMPURE, *LATER], ids=lambda bad: bad.what)
def test_it_is_refused_with_its_line(bad: Bad, folder: Path) -> None:
    file = written(folder, bad)
    with pytest.raises(Mistake) as raised:
        examined(file)
    reported(file, bad, raised.value.text, raised.value.line)


@pytest.mark.nightly  # by day tests/unit/running/catalogue/test_own_components.py: what a file does
@pytest.mark.parametrize("bad", ENDLESS, ids=lambda bad: bad.what)
def test_what_does_not_end_is_found_where_it_is(bad: Bad, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By the process that examines a file, as `clearance component check` starts it."""
    monkeypatch.setenv(own.TIMEOUT, "9")
    file = written(folder, bad)
    found = own.examine(file)
    reported(file, bad, found.text, found.line)
    stored = [json.loads(f.read_text()) for f in (folder / "cache" / "examined").glob("*.json")]
    assert [one["until"] > 0.0 for one in stored] == [True], "a busy machine is no reason for ever"


LAST = "abs(y) > 1e-9 and n < 9"


@pytest.mark.usefixtures("short")
@pytest.mark.parametrize("test", nightly_but(("n < 50", LAST), ["n < 50", "n <= p.k_goal and abs(y) > 1e-9", LAST]))
def test_a_loop_that_counts_its_turns_is_permitted(test: str, folder: Path) -> None:
    loop = f"n = 0\n    while {test}:\n        y = 0.5 * y\n        n += 1"
    examined(written(folder, Bad("", "", loop, "", "")))


@pytest.mark.usefixtures("short")
def test_a_set_that_is_only_tested_is_permitted(folder: Path) -> None:
    examined(written(folder, Bad("", "K = 1.0 if 'a' in {'a', 'b'} else 0.0", "x = x + K", "", "")))


@pytest.mark.usefixtures("short")
def test_what_only_the_program_reads_is_permitted(folder: Path) -> None:
    main = "if __name__ == '__main__':\n    print(open(__file__).read())"
    examined(written(folder, Bad("", f"import sys\nsys.path.append('/nowhere')\n{main}", "x = x + 0.0", "", "")))


@pytest.mark.by_day(24)
@pytest.mark.parametrize("component", components().values(), ids=lambda c: f"{c.role}-{c.name}")
def test_shipped_components_are_pure(component: object) -> None:
    module = source_of(component)  # type: ignore[arg-type]
    purity.check(reading.read(Path(str(module.__file__))), module.__name__)
