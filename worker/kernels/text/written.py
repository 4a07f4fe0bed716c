"""The closed loop of one scenario as a module of plain Python: what stands between its components and the loop.

Kernels are called by the names that their own modules give them; what a scenario does not have is not written. The
loop over time is `loop.fly`, the same for all. Start reading at `written`.
"""

from __future__ import annotations

import textwrap

from worker.kernels.layout import Parts
from worker.kernels.text.guidance import asked, asked_at, blank, demand, guide
from worker.kernels.text.loop import actuated, extend, initial, judgement, loop, observation, readings, surroundings
from worker.kernels.text.perception import aware, bodies
from worker.kernels.text.scenario import WIDTH, Scenario

FUNCTIONS = {
    "extend": "The parameters, and behind them what components derive from theirs.",
    "bodies": "The obstacles as they are, seen from q; o holds their states.",
    "perceived": "The obstacles as the avoider perceives them; own is the pose as the vehicle believes it.",
    "aware": "What the vehicle takes for the truth: its state, position, velocity, and the obstacles it perceives.",
    "asked": "What the avoider demands, and its memory from then on.",
    "asked_at": "What it would demand if the vehicle took itself to be at that place, all else being as it is.",
    "on_sample": "What is held of a demand between samples.",
    "demand": "The demand at this instant.",
    "guide": "One guidance sample: the demand, the avoider's memory, and earlier demands where they are kept.",
    "blank": "Guidance before its first sample.",
    "drawn": "The noise of one part of the environment at this instant.",
    "surroundings": "What the environment does to the vehicle, and the derivative of the environment's state.",
    "actuated": "The inputs that arrive, and the derivative of the actuators' states.",
    "readings": "The channels of all criteria at one instant.",
    "initial": "The state at the start: vehicle, controller, actuators, environment, obstacles, in this order.",
    "closed_loop": "Derivative of the whole state, and the criteria's channels, at one instant.",
    "settled": "The state after a step, held within the vehicle's own stops.",
    "envelope": "0 inside the vehicle's envelope, else the number of the limit that is exceeded (1 is its first).",
    "barred": "Whether the scenario's precondition fails: the first reading excludes the simulation.",
    "cost": "The value of the criterion that decides, from what became of every channel.",
    "costs_of": "The costs, from what became of every channel: that which decides first; low is worse.",
    "observation": "What a trace shows: pose, inputs, references, the obstacles' centres, channels.",
}
"""The functions that a text may have, and what it says of them."""


WRITERS = (
    *(extend, bodies, aware, asked, asked_at, demand, guide, blank),
    *(surroundings, actuated, readings, initial, loop, observation, judgement),
)


def written(parts: Parts) -> str:
    """The text of one scenario's module."""
    s = Scenario(parts, FUNCTIONS)
    for write in WRITERS:
        write(s)
    used = ", ".join(dict.fromkeys(component.name for component in s.component.values()))
    opening = textwrap.fill(f"A closed loop as it is simulated, generated from its components: {used}.", WIDTH - 3)
    head = f'"""{opening}\n\nThe loop over time is worker.kernels.loop.fly. Start reading at `closed_loop`.\n"""'
    imports = "\n".join([*s.names.imports(), "from worker.kernels.maths import kernel"])
    return "\n\n\n".join([f"{head}\n\n{imports}", *map(str, s.functions)]) + "\n"
