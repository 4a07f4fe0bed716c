"""How claims describe a system: its scope, terms for its evaluations, caveats."""
