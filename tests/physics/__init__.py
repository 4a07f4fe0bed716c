"""The physics: published values, order, closed forms, symmetry, agreement of two formulations."""
