// The rules of a claim: the limits by name, and the checks in their order, as `python -m tools.generated` wrote them.
import rules from './rules.json'

export const LIMITS = rules.limits
export const CHECKS = rules.checks
