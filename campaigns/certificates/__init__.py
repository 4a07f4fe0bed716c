"""Polynomials, and the exact check of certificates about them, which engine and audit share."""
