"""Generates the closed loop of one scenario as a module of plain Python that connects its components to the loop.

Kernels are called by their qualified names, and only what the scenario has is generated. The loop over time is
`loop.fly`, the same for all scenarios.
"""

from __future__ import annotations

import textwrap

from worker.engine.kernels.layout import Parts
from worker.engine.kernels.text import guidance, loop, perception
from worker.engine.kernels.text.scenario import WIDTH, Scenario

FUNCTIONS = {
    "extend": "The parameters, followed by the derived constants of all components.",
    "bodies": "The true obstacles as seen from q; o holds their states.",
    "perceived": "The obstacles as the avoider perceives them; own is the measured pose of the vehicle.",
    "measurements": "The measured state, position and velocity of the vehicle, and the obstacles as perceived.",
    "air_data": "The measured state of a vehicle that flies relative to the air: the true airspeed with errors.",
    "avoider_demand": "The avoider's demand and its new memory.",
    "avoider_demand_at": "The avoider's demand if the measured position were `position`, everything else unchanged.",
    "held_demand": "The demand as it is held between samples.",
    "demand": "The demand at this instant.",
    "guide": "One guidance sample: the demand, the avoider's memory and, with delayed guidance, earlier demands.",
    "initial_guidance": "The held guidance before the first sample.",
    "drawn": "The noise of one part of the environment at this instant.",
    "surroundings": "The effect of the environment on the vehicle, and the derivative of the environment's state.",
    "actuated": "The inputs that reach the vehicle, and the derivative of the actuators' states.",
    "readings": "The channels of all criteria at one instant.",
    "displaced": "The channels of all criteria with the vehicle at another place and velocity, all else unchanged.",
    "initial": "The initial state: vehicle, controller, actuators, environment, obstacles, in this order.",
    "closed_loop": "The derivative of the whole state, and the criteria's channels, at one instant.",
    "settled": "The state after a step, limited by the vehicle's mechanical stops.",
    "envelope": "0 inside the vehicle's envelope at an instant, else the number of the exceeded limit, from 1.",
    "excluded": "Whether the channels at the start violate the scenario's precondition and exclude the simulation.",
    "cost": "The value of the deciding criterion, from the reduced channels.",
    "costs_of": "The costs from the reduced channels, the deciding criterion first; lower is worse.",
    "stops": "The instants at which obstacles stop [s].",
    "turns": "The instants at which legs of obstacles end [s].",
    "observation": "The columns of a trace: pose, inputs, references, the obstacles' centres, channels.",
}
"""The functions that a text may have, with their docstrings."""


WRITERS = (
    *(loop.extend, perception.bodies, perception.measurements, perception.air_data),
    *(guidance.avoider_demand, guidance.avoider_demand_at, guidance.demand, guidance.guide, guidance.initial_guidance),
    *(loop.surroundings, loop.actuated, loop.readings, loop.initial, loop.loop, loop.observation, loop.displaced),
    loop.judgement,
)


def written(parts: Parts) -> str:
    """The source text of one scenario's module."""
    s = Scenario(parts, FUNCTIONS)
    for write in WRITERS:
        write(s)
    used = ", ".join(dict.fromkeys(component.name for component in s.component.values()))
    opening = textwrap.fill(f"The closed loop of a scenario, generated from its components: {used}.", WIDTH - 3)
    head = f'"""{opening}\n\nThe loop over time is worker.engine.kernels.loop.fly. Start reading at `closed_loop`.\n"""'
    imports = "\n".join([*s.names.imports(), "from worker.engine.kernels.maths import kernel"])
    return "\n\n\n".join([f"{head}\n\n{imports}", *map(str, s.functions)]) + "\n"
