"""The compiler: decorator, lane maths, the one loop, and the text that is written between it and the components.

Imports nothing of ours. Start reading at `loop.fly`, then `text.written`, then `bind.compile_loop`.
"""
