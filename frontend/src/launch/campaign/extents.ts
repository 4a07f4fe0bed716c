// Extents of obstacles, and their consequence for a criterion that measures to centres: a case could be clear with the
// vehicle inside an obstacle. The rule is that of the service (campaigns/checked/extents.py).
import type { Campaign, Part } from '../../api/campaign'
import type { Catalogue } from '../../client'
import { boundsOf, criterionOf, numberOf, parametersOf } from './parameters'

const SLACK = 1e-9

/** The obstacles, by their number, that extend beyond the threshold, with their extent [m]; empty if not applicable. */
export function withinOf(campaign: Campaign, catalogue: Catalogue): Map<number, number> {
  const { criterion, scenario } = campaign
  const entry = criterionOf(campaign, catalogue)
  const threshold = numberOf(criterion.threshold)
  const found = new Map<number, number>()
  if (entry?.measured_to !== 'centre' || entry.unit !== 'm' || criterion.from_centre || threshold === null) return found
  const known = new Map(parametersOf(campaign, catalogue).map((p) => [p.path, p.nominal]))
  const largest = (path: string): number => {
    const nominal = known.get(path) ?? null
    const uncertain = campaign.uncertain[path]
    const values = uncertain ? boundsOf(uncertain, nominal) : [nominal]
    return Math.max(0, ...values.map((value) => Math.abs(numberOf(value) ?? 0)))
  }
  for (const [i, part] of (scenario.obstacles ?? []).entries()) {
    const rule = catalogue.components.find((c) => c.role === 'obstacle' && c.name === part.component)?.reach
    if (!rule) continue
    const reach = rule.times * Math.hypot(...rule.of.map((name) => largest(`obstacles.${i}.${name}`)))
    if (threshold < reach * (1 - SLACK)) found.set(i, reach)
  }
  return found
}

/** The criterion that goes with obstacles: of those that reach beyond the threshold the distance to their surfaces. */
export function criterionFor(campaign: Campaign, obstacles: Part[], catalogue: Catalogue): Campaign['criterion'] {
  const within = withinOf({ ...campaign, scenario: { ...campaign.scenario, obstacles } }, catalogue)
  return within.size > 0 ? toSurfaces(campaign.criterion, catalogue) : campaign.criterion
}

/** The same threshold and requirements, kept from surfaces: never less than what was kept before. */
export function toSurfaces(criterion: Campaign['criterion'], catalogue: Catalogue): Campaign['criterion'] {
  const surface = catalogue.components.find((c) => c.role === 'criterion' && c.measured_to === 'surface')
  if (!surface) return criterion
  const { threshold, requirements } = criterion
  return { component: surface.name, parameters: {}, threshold, ...(requirements && { requirements }) }
}
