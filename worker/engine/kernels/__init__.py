"""The kernel compiler: decorator, vectorisable maths, the simulation loop and the code generated for a scenario.

Imports no other package of this project. Start reading at `loop.fly`, then `text.written`, then `bind.compile_loop`.
"""
