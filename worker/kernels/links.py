"""Components of which there may be several, link by link: each link calls the one `before` and adds one component.

Templates with named slots, as in `glue`. x is the part of the state that belongs to the chain, of which a link takes
x[X0:X1]; the component's parameters are p[P0:P1]. `chains` binds them. Start reading at `more_bodies`.
"""

from __future__ import annotations

from typing import Any

from worker.kernels.views import Errors, Seen, Sight, Surroundings, moved_by

N_U = 0
T0 = T1 = P0 = P1 = X0 = X1 = E0 = E1 = V0 = V1 = G0 = G1 = Y0 = Y1 = INDEX = NEXT = 0
SIGN = 1.0
Vehicle: Any = None
Goal: Any = None
Given: Any = None
Trimmed: Any = None
Own: Any = None
"""The parameters of the component that a link adds."""


def _slot(*_: Any) -> Any:
    raise NotImplementedError("a slot that bind did not fill")


before = body = carried = centre = point = pose = seen_at = shifted = shown = sight = solid = _slot
see = delay = mistake = move = wake = act = rest = blow = part = draw = drawn = weigh = first = derive = balance = _slot
sample = samples = place = reading = value = _slot


# What components derive from their parameters.


def as_given(p: Any) -> Any:
    """The parameters alone: no component derives anything."""
    return p


def no_balance(p: Any) -> tuple[()]:
    """The vehicle has no trim."""
    return ()


def balanced(p: Any) -> Any:
    """The vehicle's trim at the nominal values."""
    return Trimmed(*p[T0:T1])


def with_derived(p: Any) -> Any:
    """The parameters as extended so far, and what one more component derives from its own."""
    return before(p) + derive(Given(*p[E0:E1]), balance(p))


# Obstacles: as they are, and as they are perceived.


def nothing(*_: Any) -> tuple[()]:
    """The start of a chain that gives a tuple."""
    return ()


def first_body(t: float, x: Any, q: Any, p: Any) -> Any:
    """One obstacle as it is, seen from q."""
    return (body(t, x[X0:X1], q, Own(*p[P0:P1])),)


def more_bodies(t: float, x: Any, q: Any, p: Any) -> Any:
    """The obstacles before as they are, seen from q, and one more."""
    return before(t, x, q, p) + (body(t, x[X0:X1], q, Own(*p[P0:P1])),)


def first_seen(t: float, x: Any, own: Any, q: Any, v: Any, p: Any) -> Any:
    """The first obstacle as the avoider perceives it."""
    when = seen_at(t, p)
    there = body(when.at, x[X0:X1], q, Own(*p[P0:P1]))
    error = carried(t, when, there, sight(t, 0.0, point(q) + own[3:6], point(v), solid(there), p), p)
    return (shown(body(when.at, x[X0:X1], shifted(q, error), Own(*p[P0:P1])), error, q),)


def more_seen(t: float, x: Any, own: Any, q: Any, v: Any, p: Any) -> Any:
    """The obstacles perceived before, and one more."""
    when = seen_at(t, p)
    there = body(when.at, x[X0:X1], q, Own(*p[P0:P1]))
    error = carried(t, when, there, sight(t, float(INDEX), point(q) + own[3:6], point(v), solid(there), p), p)
    return before(t, x, own, q, v, p) + (shown(body(when.at, x[X0:X1], shifted(q, error), Own(*p[P0:P1])), error, q),)


def at_once(t: float, when: Seen, there: Any, error: Sight, p: Any) -> Sight:
    """No fault of timing: obstacles are seen as they are now."""
    return error


def carried_on(t: float, when: Seen, there: Any, error: Sight, p: Any) -> Sight:
    """An obstacle whose motion is known in time, seen as it was and carried on along its velocity then."""
    b = solid(there)
    return moved_by(error, when.ahead, b.vx, b.vy, b.vz)


def carried_back(t: float, when: Seen, there: Any, error: Sight, p: Any) -> Sight:
    """An obstacle with states of its own: its past is not kept, so it is taken back along its velocity now."""
    past = before(t, p)
    b = solid(there)
    return moved_by(error, past.ahead - (t - past.at), b.vx, b.vy, b.vz)


def first_centre(around: Any) -> Any:
    """The first obstacle's centre."""
    return centre(around[0])


def more_centres(around: Any) -> Any:
    """The centres of the obstacles before, and of one more."""
    return before(around) + centre(around[INDEX])


# Faults of perception, timing and navigation.


def clear_sight(t: float, index: float, own: Any, v: Any, there: Any, p: Any) -> Sight:
    """Perception without error."""
    return Sight(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)


def less_sight(t: float, index: float, own: Any, v: Any, there: Any, p: Any) -> Sight:
    """The errors of perception before, and of one more fault."""
    a = before(t, index, own, v, there, p)
    b = see(t, index, own, v, there, Own(*p[P0:P1]))
    return Sight(a.x + b.x, a.y + b.y, a.z + b.z, a.vx + b.vx, a.vy + b.vy, a.vz + b.vz, a.visible * b.visible)


def now(t: float, p: Any) -> Seen:
    """Obstacles are seen where they are at this instant."""
    return Seen(t, 0.0)


def then(t: float, p: Any) -> Seen:
    """When obstacles are seen, through the faults before and one more on what those let through."""
    first = before(t, p)
    last = delay(first.at, Own(*p[P0:P1]))
    return Seen(last.at, first.ahead + last.ahead)


def no_error(t: float, p: Any) -> Errors:
    """Navigation without error."""
    return Errors(0.0, 0.0, 0.0, 0.0, 0.0)


def more_error(t: float, p: Any) -> Errors:
    """The errors of navigation before, and of one more fault."""
    a = before(t, p)
    b = mistake(t, Own(*p[P0:P1]))
    return Errors(a.x + b.x, a.y + b.y, a.z + b.z, a.heading + b.heading, a.speed + b.speed)


# Obstacles with states of their own.


def no_move(t: float, x: Any, q: Any, v: Any, p: Any) -> tuple[()]:
    """No obstacle has a state of its own."""
    return ()


def more_moves(t: float, x: Any, q: Any, v: Any, p: Any) -> Any:
    """The derivatives of the obstacles' states before, and of one more."""
    return before(t, x, q, v, p) + move(t, x[X0:X1], q, v, Own(*p[P0:P1]))


def no_wake(p: Any) -> tuple[()]:
    """No states at the start."""
    return ()


def more_wakes(p: Any) -> Any:
    """The states of a chain at the start before, and of one more component."""
    return before(p) + wake(Own(*p[P0:P1]))


# Actuators and environment.


def as_commanded(t: float, u: Any, x: Any, p: Any) -> Any:
    """Actuators that do what they are told."""
    return u, ()


def more_actuated(t: float, u: Any, x: Any, p: Any) -> Any:
    """The inputs behind the faults before, and one more fault on the input INDEX."""
    u, dx = before(t, u, x, p)
    changed, change = act(t, u[INDEX], x[X0:X1], Own(*p[P0:P1]))
    return u[0:INDEX] + (changed,) + u[NEXT:N_U], dx + change


def more_rests(u: Any, p: Any) -> Any:
    """The states of the actuators before at the start, and of one more, given the first command."""
    return before(u, p) + rest(u[INDEX], Own(*p[P0:P1]))


def no_rest(u: Any, p: Any) -> tuple[()]:
    """No actuator has a state of its own."""
    return ()


def still(t: float, q: Any, v: Any, x: Any, p: Any) -> Any:
    """No wind, level ground."""
    return Surroundings(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), ()


def more_surroundings(t: float, q: Any, v: Any, x: Any, p: Any) -> Any:
    """What the environment does before, and one more part of it."""
    a, dx = before(t, q, v, x, p)
    b, change = part(t, point(q), point(v), x[X0:X1], p)
    total = Surroundings(
        a.wind_x + b.wind_x,
        a.wind_y + b.wind_y,
        a.wind_z + b.wind_z,
        a.slope_x + b.slope_x,
        a.slope_y + b.slope_y,
        a.rolling + b.rolling,
    )
    return total, dx + change


def undriven(t: float, q: Any, v: Any, e: Any, p: Any) -> Any:
    """A part of the environment that draws no noise apart."""
    return blow(t, q, v, e, Own(*p[P0:P1]))


def driven(t: float, q: Any, v: Any, e: Any, p: Any) -> Any:
    """A part of the environment, driven by the noise that it draws."""
    return blow(t, q, v, e, drawn(t, p), Own(*p[P0:P1]))


def draw_own(t: float, p: Any) -> Any:
    """The noise of one part of the environment at this instant."""
    return draw(t, Own(*p[P0:P1]))


# Obstacles weighed one after another by an avoider.


def unweighed(t: float, q: Any, v: Any, goal: Any, around: Any, m: Any, p: Any) -> Any:
    """What an avoider begins with before the first obstacle."""
    return first(t, q, v, goal, m, p)


def more_weighed(t: float, q: Any, v: Any, goal: Any, around: Any, m: Any, p: Any) -> Any:
    """The obstacles weighed before, and one more."""
    return weigh(before(t, q, v, goal, around, m, p), float(INDEX), around[INDEX], t, q, v, goal, m, p)


# Criteria: their channels at one instant, and their costs.


def first_sample(t: float, q: Any, v: Any, x: Any, u: Any, around: Any, p: Any) -> Any:
    """A criterion's channels for the first obstacle."""
    return sample(t, q, v, x, u, around[0], p)


def more_samples(t: float, q: Any, v: Any, x: Any, u: Any, around: Any, p: Any) -> Any:
    """The channels for the obstacles before, and for one more."""
    return before(t, q, v, x, u, around, p) + sample(t, q, v, x, u, around[INDEX], p)


def of_obstacles(t: float, q: Any, v: Any, x: Any, u: Any, around: Any, p: Any) -> Any:
    """The channels of a criterion that reads every obstacle."""
    return samples(t, q, v, x, u, around, Own(*p[P0:P1]))


def of_goal(t: float, q: Any, v: Any, x: Any, u: Any, around: Any, p: Any) -> Any:
    """The channel of a criterion that reads the way to the goal."""
    return sample(t, q, v, x, u, place(Goal(*p[G0:G1])), Own(*p[P0:P1]))


def of_flight(t: float, q: Any, v: Any, x: Any, u: Any, around: Any, p: Any) -> Any:
    """The channel of a criterion that reads the vehicle alone."""
    return sample(t, q, v, x, u, pose(x, Vehicle(*p[V0:V1])), Own(*p[P0:P1]))


def more_readings(t: float, q: Any, v: Any, x: Any, u: Any, around: Any, p: Any) -> Any:
    """The channels of the criteria before, and of one more."""
    return before(t, q, v, x, u, around, p) + reading(t, q, v, x, u, around, p)


def first_cost(lowest: Any, p: Any) -> Any:
    """The cost of the criterion that decides: its value, which is worse when low."""
    return (value(lowest[Y0:Y1], Own(*p[P0:P1])),)


def more_costs(lowest: Any, p: Any) -> Any:
    """The costs before, and of one more criterion; where high is worse its sign is turned."""
    return before(lowest, p) + (SIGN * value(lowest[Y0:Y1], Own(*p[P0:P1])),)
