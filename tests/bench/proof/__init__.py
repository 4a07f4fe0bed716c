"""Proofs that no flight of a box of parameters comes too close: a measurement, not a part of the product."""
