"""The same question over time: other runs of a campaign, and what came out of them."""
