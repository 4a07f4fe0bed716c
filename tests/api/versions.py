"""The code version of stored test runs, and a different one, as published by workers."""

from __future__ import annotations

from campaigns.versions import Code, Processor, Versions

CODE = Code(
    "c0de" * 16, {"worker.engine.problem.problem": "0" * 16, "worker.engine.components.vehicles.unicycle": "1" * 16}
)
OTHER = Code(
    "beef" * 16, {"worker.engine.problem.problem": "0" * 16, "worker.engine.components.vehicles.unicycle": "2" * 16}
)
VERSIONS = Versions(
    code=CODE.digest,
    loop="0123456789abcdef",
    packages={"numpy": "2.4.6", "scipy": "1.17.1"},
    clearance="0.1.0",
    python="3.11.7",
    system="Linux x86_64",
    cpu=Processor(model="A CPU", target="znver4", features=""),
    lanes=8,
    step=0.005,
    integrator="RK4",
)
