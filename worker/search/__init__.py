"""The search methods, one file each, found by presence. Of ours they import the statuses of evaluations, nothing else.

Start reading at `base.Method`.
"""
