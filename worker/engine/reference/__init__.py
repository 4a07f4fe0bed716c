"""The reference integrator: simulates the same components as the search by independent means, to confirm findings.

DOP853 (Dormand and Prince, order 8(5,3); Hairer, Norsett and Wanner, Solving ODEs I, section II.10) with dense output.
It differs from the lockstep loop in step, order, refinement, compiler flags and elementary functions. It evaluates only
the deciding criterion.
"""
