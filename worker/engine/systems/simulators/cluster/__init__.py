"""Evaluations on a cluster of `dask.distributed`, in slots on its nodes.

It needs the extra `cluster`. `address` names an evaluator, `connection` reaches it, `node` runs there.
"""
