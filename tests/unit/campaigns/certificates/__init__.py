"""Certificates: polynomials, coordinates, the exact check."""
