"""Requirements, the matrix of requirements and runs, and their import and export."""
