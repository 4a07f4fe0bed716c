"""What the result of any stage may say to the stages after it, to the verdict and to the pages."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

from campaigns.results.attraction import Attraction
from campaigns.results.base import Result, Status, Stop, Values
from campaigns.results.estimate import Estimation
from campaigns.results.indices import IndexStudy
from campaigns.results.measured import Measured
from campaigns.results.nominal import NominalCase
from campaigns.results.sample import Beside, Blocks, Certificate
from campaigns.results.slices import Curve
from campaigns.sample_seed import SampleSeed


class Reevaluated(Result):
    """One finding of the baseline, evaluated on this model."""

    label: str
    """Of the baseline."""
    index: int | None
    """Of its evaluation in this stage; null if it could not be evaluated."""
    parameters: Values = {}
    """As evaluated; of one that was not evaluated, as the baseline has them."""
    point: list[float] = []
    """On the unit cube of this campaign; empty if it was not evaluated."""
    status: Status | None = None
    cost: float | None = None
    reason: str = ""
    """Why it was not evaluated, or has no cost."""
    assumed: list[str] = []
    """Parameters that the baseline does not vary; they have its values, nominal ones in results of earlier versions."""
    realisation: int | None = None
    """The noise seed with which it was evaluated; null for the realisations of the campaign."""


class StageResult(Result):
    """What all results of stages have in common; which types there are is in `campaigns.stages.found`.

    A stage after it, the verdict and the pages read these properties, and do not ask of which kind it is.
    """

    followed: ClassVar[bool] = False
    """Whether validation descends from each of its evaluations, not from the lowest ones only."""

    stage: str
    """The kind of the stage."""

    @property
    def drawn(self) -> int:
        """How many of its first evaluations drew their own noise."""
        return 0

    @property
    def seeds(self) -> list[int] | None:
        """The noise seeds of these evaluations, in their order; None if they follow from the seed of the sample."""
        return None

    @property
    def counted(self) -> Blocks | None:
        """The counts of a sample of which only a part is stored."""
        return None

    @property
    def beside(self) -> Beside:
        """Its evaluations besides those that are stored."""
        return Beside() if self.counted is None else self.counted.beside

    @property
    def at_nominal(self) -> NominalCase | None:
        """The evaluation at the nominal values, if it made that."""
        return None

    @property
    def certificate(self) -> Certificate | None:
        """The independent sample that it drew to support a claim on probability, if any."""
        return None

    @property
    def estimation(self) -> Estimation | None:
        """The estimate of P(violation) over the modes of violations, if it made one or states why not."""
        return None

    @property
    def attraction(self) -> Attraction | None:
        """The region of attraction about the trim, if it proved one or states why not."""
        return None

    @property
    def sample_seed(self) -> SampleSeed | None:
        """The seed of its independent sample; None without one, and in results of earlier versions."""
        return None

    @property
    def reevaluated(self) -> Sequence[Reevaluated]:
        """The findings of the baseline as it evaluated them, in the order of the campaign: validation looks for them
        among the findings of this run, and the verdict has the changes."""
        return ()

    @property
    def slices(self) -> Sequence[Curve]:
        """Its slices through the nominal point, which show the influence of each parameter."""
        return ()

    @property
    def studies(self) -> Mapping[str, IndexStudy]:
        """Its studies of the influence of the parameters on the whole region, by the name of the method."""
        return {}

    @property
    def repeatability(self) -> Measured | None:
        """Whether the results of the simulator repeat, if it measured that."""
        return None

    @property
    def halved(self) -> bool:
        """Whether it evaluated the nominal case at half the step."""
        return False

    @property
    def made_again(self) -> Sequence[float]:
        """Values of evaluations that it made again to confirm others, which no stage stores; those of findings are in
        the findings."""
        return ()

    @property
    def unconfirmed(self) -> bool:
        """Whether a case or a random evaluation had another value when it made it again, or none."""
        return False

    @property
    def later(self) -> Sequence[tuple[str, float | None]]:
        """The flights, by name, that come closest after the horizon: closer than any evaluation, with their value
        there, or how close is not known."""
        return ()

    @property
    def ended(self) -> Stop | None:
        """How its search ended; None if it has no rule of its own."""
        return None
