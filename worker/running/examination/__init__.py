"""Examines the file of a component before it is used: text, declaration, kernels, a short simulation, the compiler.

It runs in a process of its own, `python -m worker.running.examination`. Start reading at `examine`.
"""
