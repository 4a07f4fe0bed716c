"""The search methods, one file each, discovered automatically. They import nothing else of Clearance except statuses.

Start reading at `base.Method`.
"""
