"""From the avoider's demand to the controller's: asked continuously, held between samples, late, translated.

Templates with named slots, as in `glue`. Start reading at `asked` and `held`.
"""

from __future__ import annotations

from typing import Any

from worker.kernels.maths import clip, kernel

N_G = 0
C0 = C1 = A0 = A1 = G0 = G1 = P0 = P1 = 0
DIMENSION = 2
M1 = M2 = 0
Controller: Any = None
Avoider: Any = None
Goal: Any = None
Own: Any = None
"""The parameters of the fault that a link adds."""


def _slot(*_: Any) -> Any:
    raise NotImplementedError("a slot that bind did not fill")


steer = decide = weighed = translate = late_by = blended = before = wait = _slot


def steered(t: float, q: Any, v: Any, goal: Any, around: Any, m: Any, p: Any) -> Any:
    """The demand of an avoider that weighs the obstacles one after another."""
    return decide(t, q, v, goal, weighed(t, q, v, goal, around, m, p), m, p)


def as_demanded(x: Any, want: Any, p: Any) -> Any:
    """A demand that stays as it is."""
    return want


def translated(x: Any, want: Any, p: Any) -> Any:
    """What the controller makes of a demand."""
    return translate(x, want, Controller(*p[C0:C1]))


def asked(t: float, q: Any, v: Any, around: Any, g: Any, p: Any) -> Any:
    """Continuous guidance: the avoider is asked at every stage of the integrator."""
    return steer(t, q, v, Goal(*p[G0:G1]), around, g[DIMENSION:M1], Avoider(*p[A0:A1]))[0]


def held(t: float, q: Any, v: Any, around: Any, g: Any, p: Any) -> Any:
    """Sampled guidance: the last demand holds until the next sample."""
    return g[0:DIMENSION]


KEPT = 4
"""How many earlier demands are kept for guidance that comes late: the most periods by which it can."""


def waited(t: float, q: Any, v: Any, around: Any, g: Any, p: Any) -> Any:
    """Sampled guidance that comes late: the demand of earlier samples, interpolated between two of them."""
    late = clip(late_by(p), 0.0, float(KEPT))
    return blended(late, g[0:DIMENSION], g[M1:N_G])


@kernel
def share(late: float, samples: float) -> float:
    """The weight of the demand of so many samples ago: linear interpolation in time."""
    weight = 1.0 - abs(late - samples)
    return 0.0 if weight < 0.0 else weight


def blended2(late: float, new: Any, old: Any) -> tuple[float, float]:
    """The demand in the plane as of `late` samples ago; old holds the four before the newest, latest first."""
    a, b, c, d, e = share(late, 0.0), share(late, 1.0), share(late, 2.0), share(late, 3.0), share(late, 4.0)
    return (
        a * new[0] + b * old[0] + c * old[2] + d * old[4] + e * old[6],
        a * new[1] + b * old[1] + c * old[3] + d * old[5] + e * old[7],
    )


def blended3(late: float, new: Any, old: Any) -> tuple[float, float, float]:
    """The demand in space as of `late` samples ago; old holds the four before the newest, latest first."""
    a, b, c, d, e = share(late, 0.0), share(late, 1.0), share(late, 2.0), share(late, 3.0), share(late, 4.0)
    return (
        a * new[0] + b * old[0] + c * old[3] + d * old[6] + e * old[9],
        a * new[1] + b * old[1] + c * old[4] + d * old[7] + e * old[10],
        a * new[2] + b * old[2] + c * old[5] + d * old[8] + e * old[11],
    )


def in_time(p: Any) -> float:
    """Guidance takes no time."""
    return 0.0


def later(p: Any) -> float:
    """By how many periods guidance is late, through the faults before and one more."""
    return before(p) + wait(Own(*p[P0:P1]))  # type: ignore[no-any-return]


def none_kept(t: float, want: Any, g: Any) -> tuple[()]:
    """No earlier demand is needed."""
    return ()


def four_kept(t: float, want: Any, g: Any) -> Any:
    """The last demands, latest first; at the start the first one counts as all that were before it."""
    if t > 0.0:
        return g[0:DIMENSION] + g[M1:M2]
    return want + want + want + want
