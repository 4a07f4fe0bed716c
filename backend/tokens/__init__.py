"""API tokens: each user's own, and all for administrators."""
