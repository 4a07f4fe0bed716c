"""The reference integrator: the same components as the search, flown by other means to confirm what it found.

DOP853 (Dormand and Prince, order 8(5,3); Hairer, Norsett and Wanner, Solving ODEs I, section II.10) with dense output.
It shares neither the step, the order, the refinement, the compiler's flags nor the elementary functions with the loop
that flies in lockstep. It reads the criterion that decides and no other. Start reading at `Reference`.
"""

from __future__ import annotations

from worker.reference.flown import NAME, Flight, Reference

__all__ = ["NAME", "Flight", "Reference"]
