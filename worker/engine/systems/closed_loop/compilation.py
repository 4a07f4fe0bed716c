"""Callbacks for the time while a closed loop is compiled, for the processes that run one."""

from worker.engine.kernels.durations import reported

__all__ = ["reported"]
