"""The score board: every search method and its peers on problems kept for judging. `python -m tests.bench.scoreboard`.

Start reading at `__main__`; from Python, `share` measures one method on BBOB.
"""

from tests.bench.scoreboard.bbob import share

__all__ = ["share"]
