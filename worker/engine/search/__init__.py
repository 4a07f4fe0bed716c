"""The search methods, one file each, discovered automatically. They import nothing of Clearance but statuses."""
