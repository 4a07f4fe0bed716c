"""The report for a safety case, as one HTML file and as PDF."""
