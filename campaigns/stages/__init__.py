"""The kinds of stages: one file each, discovered automatically; `worker.engine.stages` runs them.

A module of this folder with an attribute `stage` declares one: its name on the pages, its budget, its description and
the type of its result.
"""
