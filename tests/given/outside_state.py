"""Functions whose result depends on state outside of them, as texts, and functions of which it does not."""

from __future__ import annotations

READING = {
    "open": ("", "float(open('table.csv').read()) * x"),
    "open by another name": ("load = open", "float(load('table.csv').read()) * x"),
    "Path.read_text": ("from pathlib import Path", "float(Path('table.csv').read_text()) * x"),
    "a path's open": ("from pathlib import Path", "float(Path('table.csv').open().read()) * x"),
    "a global path": ("from pathlib import Path\nTABLE = Path('table.csv')", "float(TABLE.read_text()) * x"),
    "io.open": ("import io", "float(io.open('table.csv').read()) * x"),
    "np.loadtxt": ("import numpy as np", "np.loadtxt('table.csv') * x"),
    "loadtxt by its name": ("from numpy import loadtxt", "loadtxt('table.csv') * x"),
    "np.load by getattr": ("import numpy as np", "getattr(np, 'load')('table.npy') * x"),
    "np.fromfile": ("import numpy", "numpy.fromfile('table.bin')[0] * x"),
    "scipy.io": ("import scipy.io", "scipy.io.loadmat('table.mat')['a'] * x"),
    "a file that is there": ("import os", "x if os.path.exists('table.csv') else -x"),
    "a folder": ("import os", "len(os.listdir('.')) * x"),
    "sqlite3": ("import sqlite3", "sqlite3.connect('table.db').execute('select 1').fetchone()[0] * x"),
    "connect by its name": ("from sqlite3 import connect", "connect('table.db').execute('select 1').fetchone()[0] * x"),
    "environ": ("import os", "float(os.environ['GAIN']) * x"),
    "getenv": ("from os import getenv", "float(getenv('GAIN')) * x"),
    "the arguments": ("import sys", "float(sys.argv[1]) * x"),
    "the machine": ("import platform", "len(platform.node()) * x"),
    "subprocess": ("import subprocess", "float(subprocess.check_output(['cat', 'table.csv'])) * x"),
    "os.popen": ("import os", "float(os.popen('cat table.csv').read()) * x"),
    "urlopen": ("from urllib.request import urlopen", "float(urlopen('http://127.0.0.1/').read()) * x"),
    "a socket": ("import socket", "len(socket.gethostname()) * x"),
    "the clock": ("import time", "time.time() * x"),
    "the clock by its name": ("from time import perf_counter as now", "now() * x"),
    "the date": ("from datetime import datetime", "datetime.now().hour * x"),
    "random": ("import random", "random.random() * x"),
    "random by its name": ("from random import uniform", "uniform(0, 1) * x"),
    "np.random": ("import numpy as np", "np.random.rand() * x"),
    "a generator without a seed": ("import numpy as np", "np.random.default_rng().random() * x"),
    "a generator with no seed": ("from numpy.random import default_rng", "default_rng(None).random() * x"),
    "a secret": ("import secrets", "secrets.randbelow(9) * x"),
    "uuid": ("import uuid", "uuid.uuid4().int * x"),
    "a distribution": ("from scipy.stats import norm", "norm.rvs() * x"),
    "an address": ("", "id(x) * x"),
    "a hash": ("", "hash('a') * x"),
    "in a helper": ("def helper():\n    return float(open('table.csv').read())", "helper() * x"),
    "in a helper of a helper": (
        "import time\ndef inner():\n    return time.time()\ndef helper():\n    return inner()",
        "helper() * x",
    ),
    "in a lambda": ("import time", "(lambda: time.time())() * x"),
    "imported inside": ("def helper():\n    import time\n    return time.time()", "helper() * x"),
    "as a default": ("import time\ndef helper(clock=time.time):\n    return clock()", "helper() * x"),
    "as an argument": ("import time\ndef helper(clock):\n    return clock()", "helper(time.time) * x"),
    "in a list": ("import time\nCLOCKS = [time.time]", "CLOCKS[0]() * x"),
    "a module by another name": ("import numpy as np\nxp = np", "xp.loadtxt('table.csv') * x"),
    "a module in a function": (
        "import numpy as np\ndef helper():\n    xp = np\n    return xp.loadtxt('t')",
        "helper()",
    ),
    "a module as a default": ("import numpy as np\ndef helper(xp=np):\n    return xp.loadtxt('t')", "helper() * x"),
    "a module as an argument": ("import numpy as np\ndef helper(xp):\n    return xp.loadtxt('t')", "helper(np) * x"),
    "a module as a call": ("", "__import__('time').time() * x"),
    "import_module": ("from importlib import import_module", "import_module('time').time() * x"),
    "of all modules": ("import sys", "float(sys.modules['os'].environ['GAIN']) * x"),
    "of builtins": ("import builtins", "float(builtins.open('table.csv').read()) * x"),
    "everything of a module": ("from numpy import *", "loadtxt('table.csv') * x"),
    "a name that another function binds": ("def other(open):\n    return open", "float(open('table.csv').read()) * x"),
    "its value in a class": ("import numpy as np\nclass Table:\n    gain = np.random.rand()", "Table.gain * x"),
    "a name that is local elsewhere": (
        "import time\ndef other(time):\n    return time\ndef helper():\n    return time.time()",
        "other(helper()) * x",
    ),
    "bound before": ("import functools\nread = functools.partial(open, 'table.csv')", "float(read().read()) * x"),
}
"""By what it is: what stands before the function, and the expression of x that it returns."""

CLOSED = {
    "arithmetic": ("import math", "math.sin(x)"),
    "numpy": ("import numpy as np", "float(np.linalg.norm(np.array([x, 1.0])))"),
    "scipy": ("from scipy.optimize import brentq", "brentq(lambda y: y - x, -9.0, 9.0)"),
    "scipy's ode": (
        "from scipy.integrate import solve_ivp",
        "solve_ivp(lambda t, y: -y, (0.0, 1.0), [x]).y[0, -1]",
    ),
    "a generator with a seed": ("import numpy as np", "np.random.default_rng(7).random() * x"),
    "a seed by keyword": ("import numpy as np", "np.random.default_rng(seed=7).random() * x"),
    "a generator by its name": ("from numpy.random import default_rng", "default_rng(7).random() * x"),
    "random with a seed": ("from random import Random", "Random(7).random() * x"),
    "a constant date": ("from datetime import datetime, timedelta", "timedelta(x).days"),
    "json of a text": ("import json", "json.loads('1.5') * x"),
    "a path as text": ("import os", "len(os.path.join('a', 'b')) * x"),
    "numpy by another name": ("import numpy as np\nxp = np", "float(xp.sin(x))"),
    "a local name of a module": ("import time\ndef helper(time):\n    return 2.0 * time", "helper(x)"),
    "a variable of that name": ("import time\ndef helper(y):\n    time = y + 1.0\n    return time", "helper(x)"),
    "words of its own": ("def load(y):\n    return y\ndef read_gain():\n    return 2.0", "load(x) * read_gain()"),
}


def source(first: str, text: str) -> str:
    """A file with the function `fly`."""
    return f"{first}\ndef fly(x):\n    return {text}\n"
