"""The mistakes that one makes in a component, as edits of what `clearance component new` writes. See `READ`."""

from __future__ import annotations

from typing import NamedTuple


class Slip(NamedTuple):
    """An edit of a skeleton: `old` becomes `new`; it is reported in the line with `at`, with `text` (regex)."""

    what: str
    kind: str
    old: str
    new: str
    at: str
    text: str


MASS = 'm: Annotated[float, Parameter("kg", "Mass", 0.1, 1e4)] = 5.0'
OUTSIDE = "    return 1.0 if abs(x[3]) > FASTEST else 0.0"
RATES = "    return v * c, v * s, omega, (u[0] - p.drag * v) * p.per_m, (u[1] - p.turn_drag * omega) * p.per_J"
STEER = "    return (x, y), ()  # the demand"

READ = [
    Slip("an annotation is missing", "vehicle", MASS, "m = 5.0", "m = 5.0",
         r"MyVehicle\.m has no annotation.*write m: Annotated\[float, Parameter\("),
    Slip("a bracket is missing", "vehicle", "def position(x: State, p: Constants)",
         "def position(x: State, p: Constants",
         "def position", r"this is not Python: .*correct the line"),
    Slip("component = is missing", "vehicle", "component = Vehicle(", "vehicle = Vehicle(", "vehicle = Vehicle(",
         r"the Vehicle is called vehicle, expected component: write component = "),
    Slip("raise in a kernel", "vehicle", OUTSIDE, "    if x[3] > 1.0:\n        raise ValueError\n    return 0.0",
         "raise Val",
         r"outside contains `raise`, and a kernel cannot raise"),
    Slip("assert in a kernel", "vehicle", OUTSIDE, "    assert x[3] < 1.0\n    return 0.0", "assert",
         r"contains `assert`"),
    Slip("try in a kernel", "vehicle", OUTSIDE,
         "    try:\n        return 0.0\n    except ValueError:\n        return 1.0",
         "    try:", r"contains `try`"),
    Slip("a list in place of a tuple", "vehicle", "    return x[0], x[1]\n", "    return [x[0], x[1]]\n",
         "[x[0], x[1]]",
         r"position contains a list, .*write \(a, b\) in place of \[a, b\]"),
    Slip("a branch without return", "vehicle", OUTSIDE, "    if x[3] > FASTEST:\n        return 1.0", "def outside",
         r"outside can end without `return`"),
    Slip("branches of different lengths", "vehicle", "    return x[0], x[1]\n",
         "    if x[0] > 1e5:\n        return 0.0\n    return x[0], x[1]\n", "return x[0], x[1]\n",
         r"position returns a tuple of 2 here and a number at line \d+"),
    Slip("a global that is a list", "vehicle", "FASTEST = 50.0", "FASTEST = [50.0]", "abs(x[3]) > FASTEST",
         r"outside reads FASTEST, a list \(line \d+\), and kernels read constants only: make it a tuple"),
    Slip("a global that changes", "vehicle", "\n\nclass MyVehicle", "FASTEST = 60.0\n\n\nclass MyVehicle",
         "abs(x[3]) > FASTEST", r"FASTEST, which is assigned more than once \(lines \d+ and \d+\)"),
    Slip("global in a kernel", "vehicle", OUTSIDE, "    global FASTEST\n    FASTEST = 1.0\n    return 0.0",
         "    global",
         r"contains `global`"),
    Slip("a text in a kernel", "vehicle", OUTSIDE, '    print(f"{x}")\n    return 0.0', "print(", r"contains a text"),
    Slip("arguments by star", "vehicle", "def position(x: State, p: Constants)", "def position(x: State, *all)",
         "def position",
         r"position takes \* arguments"),
    Slip("an import inside a kernel", "vehicle", OUTSIDE, "    import math\n    return 0.0", "import math",
         r"contains an import inside a kernel: move it to the top"),
]  # fmt: skip
"""Found in the text: nothing is executed."""

DECLARED = [
    Slip("an annotation without a parameter", "vehicle", MASS, "m: float = 5.0", "m: float",
         r"MyVehicle\.m does not say what it is: write m: Annotated\[float, Parameter\("),
    Slip("an unknown field", "vehicle", "    outside=outside,", "    outsid=outside,", "outsid=",
         r"Vehicle has no field 'outsid' .*: did you mean 'outside'\?"),
    Slip("a missing field", "vehicle", "    outside=outside,\n", "", "component = Vehicle(",
         r"lacks outside .*: give it"),
    Slip("a typo in an import", "vehicle", "import kernel, sincos", "import kernel, sincoss", "sincoss",
         r"worker\.engine\.kernels\.maths has no 'sincoss' .*: did you mean 'sincos'\?"),
    Slip("a typo in an import by an earlier name", "vehicle", "worker.engine.kernels.maths import kernel, sincos",
         "worker.kernels.maths import kernel, sincoss", "sincoss",
         r"worker\.engine\.kernels\.maths has no 'sincoss' .*: did you mean 'sincos'\?"),
    Slip("a typo in a module", "vehicle", "from worker.engine.kernels.views", "from worker.engine.kernels.view",
         "kernels.view ",
         r"module 'worker\.engine\.kernels\.view' does not exist .*: did you mean 'worker\.engine\.kernels\.views'\?"),
    Slip("a typo in an earlier name of a module", "vehicle", "from worker.engine.kernels.views",
         "from worker.kernels.view", "kernels.view ",
         r"module 'worker\.engine\.kernels\.view' does not exist .*: did you mean 'worker\.engine\.kernels\.views'\?"),
    Slip("a name at the top does not exist", "vehicle", "FASTEST = 50.0", "FASTEST = FAST", "FASTEST = FAST",
         r"FAST is not defined"),
    Slip("a name in a function does not exist", "vehicle", "sincos(theta)", "sincos(thetta)", "thetta",
         r"thetta in derivative is not defined: did you mean 'theta'\?"),
    Slip("an exception while it is imported", "vehicle", "FASTEST = 50.0", "FASTEST = 1.0 / 0.0", "1.0 / 0.0",
         r"a division by zero \(while importing it\): "),
    Slip("sys.exit", "vehicle", "FASTEST = 50.0", "FASTEST = 50.0\nraise SystemExit(0)", "raise SystemExit",
         r"it calls sys\.exit\(0\)"),
    Slip("an unknown unit", "vehicle", '"kg", "Mass"', '"kilo", "Mass"', "Mass", r"MyVehicle\.m: unknown unit 'kilo'"),
    Slip("a unit as a word", "vehicle", 'Signal("v", "v", "m/s")', 'Signal("v", "v", "metres")', "states=(",
         r"states: unknown unit 'metres' of v: write 'm'"),
    Slip("limits in the wrong order", "vehicle", "0.1, 1e4)] = 5.0", "10.0, 1.0)] = 5.0", "Mass",
         r"low 10 must be below high 1 kg"),
    Slip("a default beyond its limits", "vehicle", "0.1, 1e4)] = 5.0", "0.1, 1e4)] = 0.0", "Mass",
         r"the default 0 must be within its limits, 0\.1 to 10000 kg"),
    Slip("the name of another component", "vehicle", 'name="my_vehicle"', 'name="unicycle"', 'name="unicycle"',
         r"the name 'unicycle' is taken by the vehicle of worker/engine/components/vehicles/unicycle\.py"),
    Slip("a name with a space", "vehicle", 'name="my_vehicle"', 'name="my vehicle"', 'name="my vehicle"',
         r"the name is 'my vehicle', expected small letters"),
    Slip("a comma that makes a tuple is missing", "vehicle", 'g} m/s"),),', 'g} m/s")),', "limits=",
         r"limits is a Limit, expected a tuple such as \(Limit\(\.\.\.\),\): the comma makes it one"),
    Slip("one text in place of a tuple", "controller", 'fits=("unicycle",)', 'fits=("unicycle")', "fits=",
         r"fits is 'unicycle', expected a tuple such as \('unicycle',\)"),
    Slip("a wrong choice", "avoider", 'demand="force"', 'demand="forces"', "demand=",
         r"demand is 'forces', expected 'force' or 'velocity'"),
    Slip("a memory without a start", "avoider", "memory=0,\n    steer=steer,\n    remember=remember,\n",
         "memory=1,\n    steer=steer,\n", "memory=1", r"memory needs remember: it gives the memory at the start"),
    Slip("kinds of demand that differ", "controller", '"velocity": follow_velocity}', '"speed": follow_velocity}',
         "references=", r"references is a dict, expected a dict by kind of demand"),
    Slip("one function too few", "controller", ', "velocity": follow_velocity}', "}", "references=",
         r"references needs the same kinds of demand as command \(force and velocity\)"),
    Slip("an argument too few", "vehicle", "def velocity(x: State, p: Constants)", "def velocity(x: State)",
         "def velocity",
         r"velocity has 1 arguments \(x\), and as velocity it is called with 2: write velocity\(x, p\)"),
    Slip("arguments in another order", "vehicle", "def derivative(t: float, x: State,",
         "def derivative(x: State, t: float,",
         "def derivative", r"the arguments of derivative are in another order .*write derivative\(t, x, u, env, p\)"),
    Slip("the decorator is missing", "vehicle", "@kernel\ndef position", "def position", "def position",
         r"position is used as position and lacks the decorator: write @kernel above it"),
    Slip("a look of a parameter that does not exist", "obstacle", 'radius="radius")', 'radius="radios")', "look=",
         r"look names 'radios', which is not one of its parameters: did you mean 'radius'\?"),
    Slip("a rate of a parameter that does not exist", "obstacle", 'per=("period",)', 'per=("periods",)', "rate=",
         r"rate needs a parameter 'periods': did you mean 'period'\?"),
    Slip("a rate with a leg to nowhere", "obstacle", 'per=("period",)', 'legs=("position", "goal")', "rate=",
         r"rate needs parameters 'goal\.x' and 'goal\.y': choose one of: position"),
    Slip("a rate that stops at no instant", "obstacle", 'per=("period",)', 'stops="stop"', "rate=",
         r"rate needs a derived constant 'stop': the obstacle derives none"),
    Slip("a reach of a parameter that does not exist", "obstacle", 'Reach(("radius",))', 'Reach(("radios",))', "reach=",
         r"reach needs a parameter 'radios': did you mean 'radius'\?"),
    Slip("an order of a parameter that does not exist", "obstacle", "component = Obstacle(\n",
         "from worker.engine.kernels.component import Order\n\ncomponent = Obstacle(\n"
         '    orders=(Order(("radios",), ("swing",), "raise swing"),),\n',
         "orders=", r"orders needs a parameter 'radios': did you mean 'radius'\?"),
    Slip("an order that is not in a tuple", "obstacle", "    moving=True,", "    moving=True,\n    orders=[],",
         "orders=", r"orders is a list; a tuple is expected: write \(Order\(\.\.\.\),\)"),
    Slip("a criterion without a threshold", "criterion", "    threshold: Annotated", "    least: Annotated",
         "parameters=MyCriterion", r"parameters needs threshold as its first field"),
    Slip("something else as component", "vehicle", "component = Vehicle(", "component = dict(", "component = dict",
         r"component is a dict, expected one of Vehicle, "),
]  # fmt: skip
"""Found when the file is imported."""

FLOWN = [
    Slip("a state too few", "vehicle", "return v * c, v * s, omega, (", "return v * c, v * s, (", "return v * c",
         r"derivative returns a tuple of 4, expected a tuple of 5 \(the rates of the states: x, y, theta, v, omega\)"),
    Slip("a state too few at the start", "vehicle", "start.theta, start.v, start.omega", "start.theta, start.v",
         "start.x,",
         r"begin returns a tuple of 4, expected a tuple of 5"),
    Slip("an input too few", "controller", "    return control(x, c, follow_force(x, demand, p), p)",
         "    return control(x, c, follow_force(x, demand, p), p)[0][:1], c", "follow_force(x, demand, p), p)[0]",
         r"command_force returns as its first result a tuple of 1, expected a tuple of 2 \(the vehicle's inputs: "),
    Slip("no memory", "avoider", STEER, "    return (x, y)  # the demand", "return (x, y)",
         r"steer returns as its first result the number .*, expected a tuple of 2 \(the force: x, y\)"),
    Slip("NaN", "vehicle", "(u[0] - p.drag * v)", "(1e400 - 1e400)", "1e400",
         r"derivative returns NaN for v, expected a finite number at t = 0 s with the nominal values"),
    Slip("a division by zero", "vehicle", "1.0 / p.m,", "1.0 / (p.m - 5.0),", "p.m - 5.0",
         r"a division by zero \(while simulating the nominal values\): "),
    Slip("a root of a negative number", "vehicle", OUTSIDE,
         "    return abs(-1.0 + x[3]) ** 0.5 * 0.0 + (x[3] - 1.0) ** 0.5 * 0.0",
         "** 0.5", r"outside returns a complex, expected 0\.0 inside the envelope"),
    Slip("a parameter that does not exist", "vehicle", "p.turn_drag * omega", "p.turndrag * omega", "p.turndrag",
         r"Constants has no 'turndrag' .*: did you mean 'turn_drag'\?"),
    Slip("a tuple of another length", "vehicle", "_, _, theta, v, omega = x", "_, theta, v, omega = x",
         "theta, v, omega = x",
         r"a tuple of another length is unpacked \(expected 4"),
    Slip("an index too large", "vehicle", "return x[3] * c, x[3] * s", "return x[7] * c, x[3] * s", "x[7]",
         r"an index beyond the end"),
    Slip("outside its envelope at the start", "vehicle", OUTSIDE, "    return 1.0", "outside=outside",
         r"outside its envelope at the start \(the speed exceeds 50 m/s\)"),
    Slip("an obstacle in place of a tuple", "obstacle", "return Body(x, y, 0.0,", "return (x, y, 0.0,", "return (x, y",
         r"body returns a tuple of 8, expected Body\(x, y, vx, "),
    Slip("a reach that is too small", "obstacle", 'Reach(("radius",))', 'Reach(("radius",), 0.9)', "reach=",
         r"reach is 0\.45 m with the nominal values, and a point of its surface is 0\.5 m from the centre"),
    Slip("a rate of zero of what swings", "obstacle", 'per=("period",), times=TWO_PI', "times=0.0", "rate=",
         r"rate is 0 rad/s with the nominal values, and its velocity turns by .* rad within .* s: declare "),
    Slip("a rate that is too small", "obstacle", 'per=("period",), times=TWO_PI', 'per=("period",)', "rate=",
         r"rate is 0\.1 rad/s with the nominal values, and its velocity turns by .* rad within .* s: declare "),
    Slip("a sight without a field", "fault", "0.0, 0.0, 0.0, 1.0)\n\n\ndef", "0.0, 0.0, 1.0)\n\n\ndef", "return Sight",
         r"Sight\(\.\.\.\) lacks visible"),
    Slip("switches that are not a list", "fault", "    return [p.at]", "    return p.at", "switches=switches",
         r"switches returns float, expected a list of instants"),
]  # fmt: skip
"""Found in a short simulation in plain Python."""

DERIVE = "@kernel\ndef derive"
COMPILED = [
    Slip("a function that cannot be compiled", "vehicle", "    return v * c, v * s, omega, (u[0]",
         "    s = s + np.real_if_close(s)\n    return v * c, v * s, omega, (u[0]", "np.real_if_close",
         r"numpy\.\w+ cannot be compiled: use functions of worker\.engine\.kernels\.maths"),
    Slip("a function without the decorator", "vehicle", DERIVE,
         "def twice(a: float) -> float:\n    return 2.0 * a\n\n\n" + DERIVE, "twice(1.0 / p.m)",
         r"twice is a plain function, and kernels call kernels only: decorate it with @kernel"),
    Slip("branches of different types", "vehicle", "    _, _, theta, v, omega = x\n",
         "    _, _, theta, v, omega = x\n    k = omega\n    if v < -1e9:\n        k = (v, omega)\n    omega = k\n",
         "omega = k",
         r"the branches have different types"),
]  # fmt: skip
"""Found by the compiler."""
