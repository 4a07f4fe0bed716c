"""Linear algebra of this process in one thread: workers run next to each other, and simulations have their own threads.

OpenBLAS starts a thread for each further core, which busy-waits: 0.1 s of processor time for each at every start,
and after every product that it takes part in. From some 100 rows on, last digits depend on the number of threads, too.
OpenBLAS reads the number once: what starts a process imports this before numpy.
"""

import os

from worker.engine.systems.simulators.slots.given import BEFORE, THREADS

os.environ.setdefault(BEFORE, os.environ.get(THREADS, ""))
os.environ[THREADS] = "1"
