"""How much of the box of the bounds a run's evaluations cover: figures of the unit cube, none of them a proof."""
