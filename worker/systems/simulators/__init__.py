"""Systems of other packages, which a campaign names as its simulator. Start reading at `simulated`."""
