"""What `simulator.yaml` states of an FMU. docs/your-own-simulator.md shows one."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from campaigns.asked.values import Identifier, Strict
from worker.engine.systems.simulators.declared.columns import MOST
from worker.engine.systems.simulators.declared.described import Basics, Finite

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class FmuParameter(Strict):
    """A parameter or input of the model; what is not stated here is read from the model.

    variable: its name in the model, by default that of the entry.
    """

    variable: str | None = None
    unit: str | None = None
    nominal: Finite | None = None
    low: Finite | None = None
    high: Finite | None = None
    text: str | None = None
    symbol: str = ""


class FmuResult(Strict):
    """A number taken from a variable of the model, read at every communication point."""

    variable: str
    take: Literal["minimum", "maximum", "final", "first_crossing"]
    level: Finite | None = None
    direction: Literal["rising", "falling", "either"] | None = None
    title: str = ""
    quantity: str = ""
    unit: str | None = None
    worse: Literal["low", "high"] = "low"
    text: str | None = None

    @model_validator(mode="after")
    def _crosses(self) -> Self:
        if self.take == "first_crossing" and self.level is None:
            raise ValueError("first_crossing requires level, the value to be crossed")
        if self.take != "first_crossing" and (self.level is not None or self.direction is not None):
            raise ValueError(f"level and direction belong to first_crossing, not to {self.take}")
        return self


class FmuColumn(Strict):
    """A variable of the model that a trace contains, by default the one of this name."""

    variable: str | None = None
    unit: str | None = None
    symbol: str = ""
    text: str | None = None


class FmuDescriptor(Basics):
    """What `simulator.yaml` states of an FMU.

    fmu: the file, in the folder of the descriptor. stop, step: end of the simulation and communication step [s], by
    default those of the model's DefaultExperiment. parameters: those that a campaign may vary, by default all
    parameters and inputs that are real numbers. fixed (key `set`): values of further variables, by their names in the
    model. trace: the variables that are recorded at the communication points, on request; time is added.
    """

    fmu: Annotated[str, Field(pattern=r"^[^/\\]+$")]
    stop: Finite | None = None
    step: Positive | None = None
    parameters: (
        dict[Identifier, Annotated[FmuParameter, BeforeValidator(lambda entry: {} if entry is None else entry)]] | None
    ) = None
    results: Annotated[dict[Identifier, FmuResult], Field(min_length=1)]
    fixed: dict[str, bool | int | Finite | str] = Field(default_factory=dict, alias="set")
    trace: Annotated[
        dict[Identifier, Annotated[FmuColumn, BeforeValidator(lambda entry: {} if entry is None else entry)]],
        Field(max_length=MOST - 1),
    ] = Field(default_factory=dict)
