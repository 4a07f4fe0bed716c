"""Generates the code between avoider and controller: the demand, continuous or sampled, delayed and translated."""

from __future__ import annotations

from worker.engine.kernels.guidance import KEPT
from worker.engine.kernels.text.perception import seen, summed
from worker.engine.kernels.text.scenario import Function, Scenario, tupled


def avoider_demand(s: Scenario) -> None:
    avoider, own = s.parts.avoider, ("t", "q", "v")
    f = s.function("avoider_demand(t, q, v, seen, memory, p)")
    bodies = "seen"
    if avoider.weigh is not None:
        bodies = "weighed"
        f.add(f"weighed = {f.call('avoider', avoider.first, *own, f.own('goal'), 'memory')}")
        for k in range(len(s.obstacles)):
            arguments = ("weighed", f"{k}.0", f"seen[{k}]", *own, f.own("goal"), "memory")
            f.add(f"weighed = {f.call('avoider', avoider.weigh, *arguments)}")
    f.add(f"return {f.call('avoider', avoider.steer, *own, f.own('goal'), bodies, 'memory')}")


def avoider_demand_at(s: Scenario) -> None:
    f = s.function("avoider_demand_at(t, x, g, position, p)")
    errors = summed(s, f, "navigation", "errors", "t")
    f.add(f"xm = {f.call('vehicle', s.parts.vehicle.measured, s.state['vehicle'], errors)}")
    f.add(f"v = {f.call('vehicle', s.parts.vehicle.velocity, 'xm')}", f"seen = {seen(s, f, 'position')}")
    f.add(f"return avoider_demand(t, position, v, seen, {memory(s)}, p)[0]")


def memory(s: Scenario, guidance: str = "g") -> str:
    """The expression for the avoider's memory within the held guidance."""
    count = s.parts.avoider.memory
    return f"{guidance}[{s.dimension}:{s.dimension + count}]" if count else "()"


def demand(s: Scenario) -> None:
    f, d = s.function("demand(t, q, v, seen, g, p)"), s.dimension
    if not s.parts.sampled:
        f.add(f"return avoider_demand(t, q, v, seen, {memory(s)}, p)[0]")
    elif not s.parts.late:
        f.add(f"return g[0:{d}]")
    else:
        waits = [f.call(prefix, s.component[prefix].kernel) for prefix in s.faults["guidance"]]
        kept, module = d + s.parts.avoider.memory, s.names.module("worker.engine.kernels.guidance")
        f.add(f"late = {' + '.join(waits)}")
        f.add(f"return {module}.blended(late, g[0:{d}], g[{kept}:{kept + KEPT * d}])")


def translated(s: Scenario, f: Function, x: str) -> str:
    """The expression for a demand as the controller's own references, if it translates demands."""
    translate = s.parts.controller.translate
    return f.call("controller", translate[s.parts.avoider.demand], x, "want") if translate else "want"


def guide(s: Scenario) -> None:
    d, late = s.dimension, s.parts.late
    f = s.function("held_demand(xm, want, p)")
    f.add(f"return {translated(s, f, 'xm') if s.parts.sampled and not late else 'want'}")
    f = s.function("guide(t, x, g, p)")
    f.add("xm, q, v, seen = measurements(t, x, p)", f"want, memory = avoider_demand(t, q, v, seen, {memory(s)}, p)")
    if late:
        first = d + s.parts.avoider.memory
        f.add(f"earlier = g[0:{d}] + g[{first}:{first + (KEPT - 1) * d}] if t > 0.0 else {' + '.join(['want'] * KEPT)}")
    f.add(f"return held_demand(xm, want, p) + memory{' + earlier' if late else ''}")


def initial_guidance(s: Scenario) -> None:
    d = s.dimension
    f = s.function("initial_guidance(p)")
    nothing = [tupled(["0.0"] * d)]
    if s.parts.avoider.memory:
        nothing.append(f.call("avoider", s.parts.avoider.remember))
    f.add(f"return {' + '.join([*nothing, *([tupled(['0.0'] * (KEPT * d))] if s.parts.late else [])])}")
