"""Search methods and budgets for a simulator, proposed from what its evaluations took in earlier runs."""
