"""The digests of the simulators' files as a catalogue publishes them: which runs measured what is installed now.

They are those that a run stores when it opens the simulator. A package that opens its simulator itself has none here,
nor has a function whose code cannot be read exactly: nothing rules out that it has changed.
"""

from __future__ import annotations

from campaigns.catalogue import Catalogue
from campaigns.identity.identity import is_read
from worker.engine.systems.simulators.declared.described import Described
from worker.engine.systems.simulators.declared.folder import digest_of_place
from worker.engine.systems.simulators.declared.simulator import Simulator
from worker.running.catalogue.files import PythonFunction
from worker.running.catalogue.installed import simulators


def with_digests(catalogue: Catalogue) -> Catalogue:
    """The catalogue of this installation with the digests of its simulators as their files are now."""
    found = {name: _digest(simulator) for name, simulator in simulators().items()}
    return catalogue.model_copy(update={"digests": {name: digest for name, digest in found.items() if digest}})


def digest_of(name: str) -> str:
    """The digest of a simulator of this installation; empty where there is none."""
    simulator = simulators().get(name)
    return "" if simulator is None else _digest(simulator)


def _digest(simulator: Simulator | Described | PythonFunction) -> str:
    """Empty where there is none."""
    try:
        if isinstance(simulator, Described):
            return simulator.digest
        if isinstance(simulator, PythonFunction) and simulator.place:
            digest = digest_of_place(simulator.place)
            return digest if is_read(digest) else ""
    except OSError:  # a file that cannot be read is reported by the run that opens it
        return ""
    return ""
