// The rules of a claim: the limits by name, and the checks in their order, as `python -m tools.generated pages` wrote them.
import rules from '../generated/rules.json'

export const LIMITS = rules.limits
export const CHECKS = rules.checks
