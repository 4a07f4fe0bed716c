"""The wall around everything compiled: decorator, lane maths, the one closed loop, and what fills its slots.

Imports nothing of ours. Start reading at `loop.fly`, then `glue.closed_loop`, then `bind.bind`.
"""
