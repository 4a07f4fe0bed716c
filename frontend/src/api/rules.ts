// The rules of a claim: the limits by name, and the checks in their order; what a campaign means that leaves a field out. As
// `python -m tools.generated pages` wrote them.
import rules from '../generated/rules.json'

export const LIMITS = rules.limits
export const CHECKS = rules.checks
export const DEFAULTS = rules.defaults
