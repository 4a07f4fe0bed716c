"""Generates the closed loop itself: parameters, initial state, derivative, criteria and checks."""

from __future__ import annotations

from worker.engine.kernels.component import Criterion
from worker.engine.kernels.layout import derivations
from worker.engine.kernels.text.guidance import memory, translated
from worker.engine.kernels.text.scenario import Function, Scenario, tupled, variable


def extend(s: Scenario) -> None:
    f, terms = s.function("extend(p)"), ["p"]
    for section, derived in derivations(s.parts, s.sections):
        parameters = f"{s.name(section.prefix, section.fields)}(*p[{section.first}:{section.last}])"
        trim = f.own("trim") if s.parts.vehicle.trim else "()"
        terms.append(variable(section.prefix))
        f.add(f"{terms[-1]} = {s.name(section.prefix, derived.derive)}({parameters}, {trim})")
    f.add(f"return {' + '.join(terms)}")


def surroundings(s: Scenario) -> None:
    if not s.environment:
        return
    for i, prefix in enumerate(s.environment):
        if s.component[prefix].draw is not None:
            f = s.function(f"drawn_{i}(t, p)")
            f.add(f"return {f.call(prefix, s.component[prefix].draw, 't')}")
    changes: list[str] = []
    f = s.function("surroundings(t, q, v, e, p)")
    for prefix, state in s.each(s.environment, "e").items():
        change = f"de_{len(changes)}" if state != "()" else "_"
        changes += [change] if state != "()" else []
        noise = [] if s.component[prefix].draw is None else [f"drawn_{prefix.rpartition('.')[2]}(t, p)"]
        blow = f.call(prefix, s.component[prefix].blow, "t", s.space("q"), s.space("v"), state, *noise)
        if prefix == s.environment[0]:
            f.add(f"env, {change} = {blow}")
        else:
            f.add(f"more, {change} = {blow}", f"env = {s.view('both_surroundings')}(env, more)")
    f.add(f"return env, {' + '.join(changes) or '()'}")


def actuated(s: Scenario) -> None:
    if "actuator" not in s.faults:
        return
    changes: list[str] = []
    f = s.function("actuated(t, u, a, p)")
    for prefix, state in s.each(s.faults["actuator"], "a").items():
        change, on = f"da_{len(changes)}" if state != "()" else "_", s.inputs[prefix]
        changes += [change] if state != "()" else []
        f.add(f"arrives, {change} = {f.call(prefix, s.component[prefix].kernel, 't', f'u[{on}]', state)}")
        f.add(f"u = {tupled(f'u[{k}]' if k != on else 'arrives' for k in range(len(s.parts.vehicle.inputs)))}")
    f.add(f"return u, {' + '.join(changes) or '()'}")


def readings(s: Scenario) -> None:
    terms: list[str] = []
    f = s.function("readings(t, q, v, x, u, around, p)")
    for prefix in s.channels.of:
        criterion: Criterion = s.component[prefix]
        if criterion.of == "obstacles":
            each = [f"around[{k}]" for k in range(len(s.obstacles))]
        elif criterion.of == "goal":
            each = [tupled(f"{f.own('goal')}.{axis}" for axis in "xyz"[: s.dimension])]
        else:
            each = [f.call("vehicle", s.parts.vehicle.pose, "x")]
        sample = criterion.sample[s.dimension]
        for to in each:
            terms.append(f"{variable(prefix)}_{len(terms)}")
            f.add(f"{terms[-1]} = {f.call(prefix, sample, 't', 'q', 'v', 'x', 'u', to)}")
    f.add(f"return {' + '.join(terms)}")


def initial(s: Scenario) -> None:
    f, vehicle, n, x = s.function("initial(p)"), s.parts.vehicle, s.states, "xv"
    f.add(f"xv = {s.name('vehicle', vehicle.begin)}({f.own('start')}, {f.own('vehicle')})")
    if n.obstacles:
        x = "x"
        f.add(f"xo = {_woken(s, f, s.obstacles)}", "# The states in between are still unknown and not read.")
        f.add(f"x = xv + {tupled(['0.0'] * (n.controller + n.actuators + n.environment))} + xo")
    f.add(f"xm, q, v, seen = measurements(0.0, {x}, p)")
    f.add(f"want, _ = avoider_demand(0.0, q, v, seen, {memory(s, 'initial_guidance(p)')}, p)")
    if n.environment:
        f.add(f"xe = {_woken(s, f, s.environment)}")
    if vehicle.felt:
        _located(s, f)
        env = f"surroundings(0.0, q, v, {'xe' if n.environment else '()'}, p)[0]" if s.environment else s.view("STILL")
        f.add(f"xm = air_data(0.0, xv, {env}, p)")
    if s.parts.controller.translate:
        f.add(f"want = {translated(s, f, 'xm')}")
    kind = s.parts.avoider.demand
    f.add(f"xc = {f.call('controller', s.parts.controller.prepare[kind], 'xm', 'want')}")
    if n.actuators:
        f.add(f"u, _ = {f.call('controller', s.parts.controller.command[kind], '0.0', 'xm', 'xc', 'want')}")
        rests = [fault for fault in s.faults["actuator"] if s.component[fault].states]
        f.add(f"xa = {' + '.join(f.call(r, s.component[r].rest, f'u[{s.inputs[r]}]') for r in rests)}")
    counts = {"xa": n.actuators, "xe": n.environment, "xo": n.obstacles}
    f.add(f"return {' + '.join(['xv', 'xc', *(name for name, count in counts.items() if count)])}")


def _woken(s: Scenario, f: Function, prefixes: list[str]) -> str:
    return " + ".join(f.call(prefix, s.component[prefix].wake) for prefix in prefixes if s.component[prefix].states)


def _located(s: Scenario, f: Function) -> None:
    """Add the lines from the true state of the vehicle to its position and velocity."""
    vehicle = s.parts.vehicle
    f.add(f"q = {f.call('vehicle', vehicle.position, 'xv')}", f"v = {f.call('vehicle', vehicle.velocity, 'xv')}")


def _instant(s: Scenario, f: Function) -> str:
    """Add the lines from the state to the inputs of the vehicle at one instant; returns the environment's variable."""
    vehicle, controller = s.parts.vehicle, s.parts.controller
    f.add("xm, q, v, seen = measurements(t, x, p)", "want = demand(t, q, v, seen, g, p)", f"xv = {s.state['vehicle']}")
    _located(s, f)
    env = "env" if s.environment else s.view("STILL")
    if s.environment:
        f.add(f"env, dxe = surroundings(t, q, v, {s.state['environment']}, p)")
    if vehicle.felt:
        f.add(f"xm = air_data(t, xv, {env}, p)")
    if controller.translate and (s.parts.late or not s.parts.sampled):
        f.add(f"want = {translated(s, f, 'xm')}")
    command = controller.command[s.parts.avoider.demand]
    f.add(f"u, dxc = {f.call('controller', command, 't', 'xm', s.state['controller'], 'want')}")
    if "actuator" in s.faults:
        f.add(f"u, dxa = actuated(t, u, {s.state['actuators']}, p)")
    f.add(f"around = bodies(t, {s.state['obstacles']}, q, p)")
    return env


def loop(s: Scenario) -> None:
    f, vehicle = s.function("closed_loop(t, x, g, p)"), s.parts.vehicle
    env = _instant(s, f)
    f.add(f"dxv = {f.call('vehicle', vehicle.derivative, 't', 'xv', 'u', env)}")
    terms = ["dxv", "dxc"] + ["dxa"] * bool(s.states.actuators) + ["dxe"] * bool(s.states.environment)
    for prefix, state in s.each(s.obstacles, "x", s.states.total - s.states.obstacles).items():
        if state != "()":
            terms.append(f"do_{len(terms)}")
            f.add(f"{terms[-1]} = {f.call(prefix, s.component[prefix].move, 't', state, 'q', 'v')}")
    f.add(f"return {' + '.join(terms)}, readings(t, q, v, xv, u, around, p)")


def observation(s: Scenario) -> None:
    f, vehicle = s.function("observation(t, x, g, p)"), s.parts.vehicle
    _instant(s, f)
    references = s.parts.controller.references[s.parts.avoider.demand]
    centres = [f"centre_{k}" for k in range(len(s.obstacles))]
    for k, centre in enumerate(centres):
        f.add(f"{centre} = around[{k}].x, around[{k}].y, {f'around[{k}].z' if s.dimension == 3 else '0.0'}")
    shown = [f.call("vehicle", vehicle.pose, "xv"), "u", f.call("controller", references, "xm", "want"), *centres]
    f.add(f"return {' + '.join([*shown, 'readings(t, q, v, xv, u, around, p)'])}")


def displaced(s: Scenario) -> None:
    f = s.function("displaced(t, x, q, v, u, p)")
    f.add(f"around = bodies(t, {s.state['obstacles']}, q, p)")
    f.add(f"return readings(t, q, v, {s.state['vehicle']}, u, around, p)")


def judgement(s: Scenario) -> None:
    vehicle, n = s.parts.vehicle, s.states
    f = s.function("settled(x, p)")
    rest = f" + x[{n.vehicle}:{n.total}]" if n.total > n.vehicle else ""
    f.add(f"return {f.call('vehicle', vehicle.settle, s.state['vehicle'])}{rest}" if vehicle.settle else "return x")
    f, x = s.function("envelope(t, x, p)"), s.state["vehicle"]
    if vehicle.felt and s.environment:
        f.add(f"xv = {x}")
        _located(s, f)
        f.add(f"env, _ = surroundings(t, q, v, {s.state['environment']}, p)")
        x = f.call("vehicle", vehicle.felt, "xv", "env")
    f.add(f"return {f.call('vehicle', vehicle.outside, x)}")
    if s.channels.stops:
        f, stopping = s.function("stops(p)"), [s.obstacles[i] for i in s.channels.stops]
        f.add(f"return {tupled(f'{f.own(o)}.{s.component[o].rate.stops}' for o in stopping)}")
    if s.channels.turns:
        _turns(s)
    f = s.function("excluded(first, p)")
    f.add(f"return {f.call('criterion', s.parts.criterion.excluded, _channels(s, 'criterion', 'first'))}")
    f = s.function("cost(found, p)")
    f.add(f"return {f.call('criterion', s.parts.criterion.value, _channels(s, 'criterion', 'found'))}")
    f, costs = s.function("costs_of(found, p)"), ["cost(found, p)"]
    for prefix in list(s.parts.criteria)[1:]:
        criterion: Criterion = s.component[prefix]
        value = f.call(prefix, criterion.value, _channels(s, prefix, "found"))
        costs.append(f"-{value}" if criterion.worse == "high" else value)
    f.add(f"return {tupled(costs)}")


def _turns(s: Scenario) -> None:
    """The ends of legs: declared constants, else those of legs one after the other from t = 0."""
    f, ends = s.function("turns(p)"), []
    for i, k in s.channels.turns:
        prefix, rate = s.obstacles[i], s.component[s.obstacles[i]].rate
        if rate.stops:
            ends.append(f"{f.own(prefix)}.{rate.stops}")
            continue
        section = next(each for each in s.sections if each.prefix == prefix)
        p = {q.name: f"p[{section.first + n}]" for n, q in enumerate(section.parameters)}
        start, end = (tupled(p.get(f"{name}.{a}", "0.0") for a in "xyz") for name in rate.legs[k : k + 2])
        speed = " * ".join([repr(rate.times), *(f"abs({p[name]})" for name in rate.of)])
        begins = f"leg_{i}_{k - 1}[4]" if k else "0.0"
        leg = f"{s.names.module('worker.engine.physics.paths')}.leg"
        on = f"{p[rate.used]} > {k + 0.5}" if rate.used and k else "True"
        f.add(f"leg_{i}_{k} = {leg}({start}, {end}, {speed}, {begins}, {on})")
        ends.append(f"leg_{i}_{k}[4]")
    f.add(f"return {tupled(ends)}")


def _channels(s: Scenario, prefix: str, found: str) -> str:
    first, last = s.channels.of[prefix]
    return f"{found}[{first}:{last}]"
