"""A fixed-wing airframe: its coefficients, forces and moments, rigid-body motion, trim and linear derivatives.

Srikanthakumar, equations 3.38 to 3.44; coefficients of the Ultra Stick 25e as published by the University of Minnesota.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

from worker.engine.kernels.component import Parameter, extended
from worker.engine.kernels.maths import PI, atan2, clip, kernel
from worker.engine.physics.space import Attitude, Vector

Controls = tuple[float, float, float, float]


class Airframe(NamedTuple):
    """Ultra Stick 25e; the subscripts e, a, r of a coefficient mean per radian of elevator, aileron, rudder."""

    m: Annotated[float, Parameter("kg", "Mass", 0.1, 100.0)] = 1.9
    I_xx: Annotated[float, Parameter("kg m2", "Moment of inertia, roll", 1e-4, 1e3)] = 0.0894
    I_yy: Annotated[float, Parameter("kg m2", "Moment of inertia, pitch", 1e-4, 1e3)] = 0.1444
    I_zz: Annotated[float, Parameter("kg m2", "Moment of inertia, yaw", 1e-4, 1e3)] = 0.162
    I_xz: Annotated[float, Parameter("kg m2", "Product of inertia", -1e2, 1e2)] = 0.0
    S: Annotated[float, Parameter("m2", "Wing area", 1e-2, 1e2)] = 0.3097
    b: Annotated[float, Parameter("m", "Wing span", 0.1, 50.0)] = 1.27
    c: Annotated[float, Parameter("m", "Mean aerodynamic chord", 1e-2, 10.0, symbol="c̄")] = 0.25
    x_a: Annotated[float, Parameter("m", "Aerodynamic centre ahead of the centre of gravity", -1.0, 1.0)] = 0.0045
    z_p: Annotated[float, Parameter("m", "Thrust line below the centre of gravity", -1.0, 1.0)] = 0.046
    C_dt: Annotated[float, Parameter("N", "Thrust at full throttle", 0.0, 1e4, symbol="C_δt")] = 12.19
    I_p: Annotated[float, Parameter("kg m2", "Moment of inertia of the propeller", 0.0, 10.0)] = 0.00012991
    omega_p: Annotated[float, Parameter("rad/s", "Turn rate of the propeller", -1e4, 1e4, symbol="ω_p")] = 827.0
    C_L0: Annotated[float, Parameter("", "Lift at zero angle of attack", -1.0, 2.0)] = 0.1086
    C_La: Annotated[float, Parameter("1/rad", "Lift, angle of attack", 0.0, 20.0, symbol="C_Lα")] = 4.58
    C_Lq: Annotated[float, Parameter("1/rad", "Lift, pitch rate", -50.0, 50.0)] = 6.1639
    C_Lde: Annotated[float, Parameter("1/rad", "Lift, elevator", -5.0, 5.0, symbol="C_Lδe")] = 0.0983
    C_D0: Annotated[float, Parameter("", "Least drag", 0.0, 1.0)] = 0.0434
    C_LD: Annotated[float, Parameter("", "Lift at the least drag", -1.0, 2.0)] = 0.23
    e: Annotated[float, Parameter("", "Oswald efficiency", 0.1, 1.0)] = 0.75
    C_Dde: Annotated[float, Parameter("1/rad", "Drag, elevator", 0.0, 5.0, symbol="C_Dδe")] = 0.0135
    C_Dda: Annotated[float, Parameter("1/rad", "Drag, aileron", 0.0, 5.0, symbol="C_Dδa")] = 0.0302
    C_Ddr: Annotated[float, Parameter("1/rad", "Drag, rudder", 0.0, 5.0, symbol="C_Dδr")] = 0.0303
    C_Yb: Annotated[float, Parameter("1/rad", "Side force, sideslip", -5.0, 5.0, symbol="C_Yβ")] = -0.4889
    C_Yp: Annotated[float, Parameter("1/rad", "Side force, roll rate", -5.0, 5.0)] = -0.0375
    C_Yr: Annotated[float, Parameter("1/rad", "Side force, yaw rate", -5.0, 5.0)] = 0.15
    C_Ydr: Annotated[float, Parameter("1/rad", "Side force, rudder", -5.0, 5.0, symbol="C_Yδr")] = 0.1913
    C_lb: Annotated[float, Parameter("1/rad", "Roll moment, sideslip", -5.0, 5.0, symbol="C_lβ")] = -0.0545
    C_lp: Annotated[float, Parameter("1/rad", "Roll moment, roll rate", -5.0, 5.0)] = -0.4496
    C_lr: Annotated[float, Parameter("1/rad", "Roll moment, yaw rate", -5.0, 5.0)] = 0.1086
    C_lda: Annotated[float, Parameter("1/rad", "Roll moment, aileron", -5.0, 5.0, symbol="C_lδa")] = 0.1646
    C_ldr: Annotated[float, Parameter("1/rad", "Roll moment, rudder", -5.0, 5.0, symbol="C_lδr")] = 0.0115
    C_m0: Annotated[float, Parameter("", "Pitch moment at zero angle of attack", -1.0, 1.0)] = -0.0278
    C_ma: Annotated[float, Parameter("1/rad", "Pitch moment, angle of attack", -20.0, 20.0, symbol="C_mα")] = -0.723
    C_mq: Annotated[float, Parameter("1/rad", "Pitch moment, pitch rate", -200.0, 0.0)] = -13.5664
    C_mde: Annotated[float, Parameter("1/rad", "Pitch moment, elevator", -10.0, 10.0, symbol="C_mδe")] = -1.13
    C_nb: Annotated[float, Parameter("1/rad", "Yaw moment, sideslip", -5.0, 5.0, symbol="C_nβ")] = 0.0723
    C_np: Annotated[float, Parameter("1/rad", "Yaw moment, roll rate", -5.0, 5.0)] = 0.118
    C_nr: Annotated[float, Parameter("1/rad", "Yaw moment, yaw rate", -5.0, 5.0)] = -0.1833
    C_nda: Annotated[float, Parameter("1/rad", "Yaw moment, aileron", -5.0, 5.0, symbol="C_nδa")] = -0.0574
    C_ndr: Annotated[float, Parameter("1/rad", "Yaw moment, rudder", -5.0, 5.0, symbol="C_nδr")] = -0.1811
    stop: Annotated[float, Parameter("rad", "Stop of every control surface", 1e-2, 1.5, symbol="δ_max")] = (
        0.4363323129985824
    )
    rho: Annotated[float, Parameter("kg/m3", "Density of the air", 0.1, 2.0, symbol="ρ")] = 1.225
    g: Annotated[float, Parameter("m/s2", "Gravity", 9.0, 10.0)] = 9.81


class More(NamedTuple):
    """Constants that follow from an airframe."""

    per_m: float
    pressure: float
    half_b: float
    half_c: float
    induced: float
    per_xx: float
    per_yy: float
    per_zz: float
    across_x: float
    across_y: float
    across_z: float
    couples_x: float
    couples_y: float
    couples_z: float
    per_det: float
    spins_y: float
    spins_z: float


Constants = extended("Constants", Airframe, More)


class Trimmed(NamedTuple):
    """Straight level flight: angle of attack and elevator [rad], throttle [0 to 1]."""

    alpha: float
    elevator: float
    throttle: float


@kernel
def constants(p: Airframe) -> tuple[float, ...]:
    """The fields of `Constants`."""
    couples_x = p.I_xz / p.I_xx
    couples_z = p.I_xz / p.I_zz
    spin = p.I_p * p.omega_p
    return (
        *p[0:],
        1.0 / p.m,
        0.5 * p.rho * p.S,
        0.5 * p.b,
        0.5 * p.c,
        p.S / (PI * p.e * p.b * p.b),
        1.0 / p.I_xx,
        1.0 / p.I_yy,
        1.0 / p.I_zz,
        (p.I_zz - p.I_yy) / p.I_xx,
        (p.I_xx - p.I_zz) / p.I_yy,
        (p.I_yy - p.I_xx) / p.I_zz,
        couples_x,
        p.I_xz / p.I_yy,
        couples_z,
        1.0 / (1.0 - couples_x * couples_z),
        spin / p.I_yy,
        spin / p.I_zz,
    )


@kernel
def stopped(u: Controls, stop: float) -> Controls:
    """Elevator, aileron, rudder and throttle, limited by their stops."""
    return clip(u[0], -stop, stop), clip(u[1], -stop, stop), clip(u[2], -stop, stop), clip(u[3], 0.0, 1.0)


@kernel
def loads(air: Vector, rates: Vector, u: Controls, p: Any) -> tuple[Vector, Vector]:
    """Aerodynamic and propulsive force per mass [m/s2] and moment [N m], in body axes.

    air: velocity through the air in body axes [m/s]; rates: turn rates about them [rad/s]; p: `Constants`.
    """
    elevator, aileron, rudder, throttle = u
    flat = air[0] * air[0] + air[2] * air[2]
    square = flat + air[1] * air[1]
    speed = math.sqrt(square)
    forward = math.sqrt(flat)
    per_both = 1.0 / (speed * forward)
    per_speed = per_both * forward
    per_forward = per_both * speed
    alpha = atan2(air[2], air[0])
    beta = atan2(air[1], forward)
    c_a, s_a = air[0] * per_forward, air[2] * per_forward
    c_b, s_b = forward * per_speed, air[1] * per_speed
    roll = rates[0] * p.half_b * per_speed
    pitch = rates[1] * p.half_c * per_speed
    yaw = rates[2] * p.half_b * per_speed
    lift = p.C_L0 + p.C_La * alpha + p.C_Lq * pitch + p.C_Lde * elevator
    extra = lift - p.C_LD
    drag = p.C_D0 + p.induced * extra * extra
    drag += p.C_Dde * abs(elevator) + p.C_Dda * abs(aileron) + p.C_Ddr * abs(rudder)
    side = p.C_Yb * beta + p.C_Yp * roll + p.C_Yr * yaw + p.C_Ydr * rudder
    pressure = p.pressure * square
    back = drag * c_b + side * s_b
    x = pressure * (lift * s_a - back * c_a)
    y = pressure * (side * c_b - drag * s_b)
    z = -pressure * (lift * c_a + back * s_a)
    thrust = p.C_dt * throttle
    c_l = p.C_lb * beta + p.C_lp * roll + p.C_lr * yaw + p.C_lda * aileron + p.C_ldr * rudder
    c_m = p.C_m0 + p.C_ma * alpha + p.C_mq * pitch + p.C_mde * elevator
    c_n = p.C_nb * beta + p.C_np * roll + p.C_nr * yaw + p.C_nda * aileron + p.C_ndr * rudder
    moment = (
        pressure * p.b * c_l,
        pressure * p.c * c_m - p.x_a * z + p.z_p * thrust,
        pressure * p.b * c_n + p.x_a * y,
    )
    return ((x + thrust) * p.per_m, y * p.per_m, z * p.per_m), moment


@kernel
def turning(rates: Vector, moment: Vector, p: Any) -> Vector:
    """Derivatives of the turn rates [rad/s2]: equation 3.43 solved for them."""
    roll, pitch, yaw = rates
    about_x = moment[0] * p.per_xx - p.across_x * pitch * yaw + p.couples_x * roll * pitch
    about_z = moment[2] * p.per_zz - p.across_z * roll * pitch - p.couples_z * pitch * yaw - p.spins_z * pitch
    about_y = moment[1] * p.per_yy - p.across_y * roll * yaw + p.spins_y * yaw
    return (
        (about_x + p.couples_x * about_z) * p.per_det,
        about_y - p.couples_y * (roll * roll - yaw * yaw),
        (about_z + p.couples_z * about_x) * p.per_det,
    )


@kernel
def accelerations(a: Attitude, v: Vector, air: Vector, rates: Vector, u: Controls, p: Any) -> tuple[Vector, Vector]:
    """Derivatives of the body's velocity over ground v [m/s2] and of its turn rates [rad/s2], in body axes."""
    force, moment = loads(air, rates, u, p)
    roll, pitch, yaw = rates
    weight = p.g * a.c_pitch
    return (
        yaw * v[1] - pitch * v[2] - p.g * a.s_pitch + force[0],
        roll * v[2] - yaw * v[0] + weight * a.s_roll + force[1],
        pitch * v[0] - roll * v[1] + weight * a.c_roll + force[2],
    ), turning(rates, moment, p)
