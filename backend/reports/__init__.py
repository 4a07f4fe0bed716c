"""The report for a safety case: one file of HTML, the same as PDF."""
