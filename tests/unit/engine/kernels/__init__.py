"""Unit tests of engine/kernels."""
