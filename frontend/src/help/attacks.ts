// The classes of attack on a verdict: how it could claim too much, and the countermeasures.
import { LIMITS } from '../api/rules'
import { percent, plain } from '../format/numbers'

export interface Attack {
  id: string
  title: string
  /** How a verdict could be wrong. */
  danger: string
  /** What the service does about it. */
  answer: string
}

export const ATTACKS: readonly Attack[] = [
  {
    id: 'uncounted',
    title: 'A violation that was simulated and not counted',
    danger: 'A stage meets a violation, and the verdict looks at the findings alone.',
    answer:
      `The minimum is taken over every stored evaluation of every stage. Stored violations are counted, up to ${LIMITS.violations} of them are simulated again, and no run with one is cleared. Whatever is lower than the worst case becomes a candidate itself.`,
  },
  {
    id: 'lazy',
    title: 'Methods that agree without searching',
    danger: 'Two methods stop after a few evaluations and report the nominal value: they agree, but neither has searched.',
    answer:
      'A method counts only after a least budget, with a best value below nominal, and when its best is in the basin of a listed finding. Local methods must have converged. Methods of at least two families, or the two sides of Auto, must reach the worst case, and every global one.',
  },
  {
    id: 'vacuous',
    title: 'An encounter that does not take place',
    danger:
      'The horizon ends before the obstacle is near, the vehicle does not move, the avoidance makes no difference, or no uncertain parameter changes anything. Such a run is safe, and says nothing about the avoidance.',
    answer:
      'Four checks: the closest approach is inside the horizon, and no flight comes closer when simulated on to twice of it, or until it fails, moved straight on past the shapes of the obstacles and followed around turns from there; the vehicle moves; the nominal case is simulated without seeing any obstacle and must come closer; the criterion varies over the evaluations.',
  },
  {
    id: 'aliased',
    title: 'An obstacle that moves within the step',
    danger: 'An orbit of half a step: the step, half the step and the reference integrator all see the obstacle at one place.',
    answer:
      'Obstacles declare how fast they turn. A run is not cleared if one turns by more than pi/4 within a step, anywhere within the bounds, and the reference integrator looks inside its steps at such obstacles.',
  },
  {
    id: 'zero',
    title: 'A collision whose tolerance is 0',
    danger: 'A tolerance that is a fraction of the distance is 0 where the distance is 0: no collision could be confirmed.',
    answer:
      `Tolerances have a floor of ${plain(LIMITS.rounding)} of the scale of the threshold. A violation counts when every integration violates, however much they differ; if they differ beyond tolerance, the verdict reports it.`,
  },
  {
    id: 'jump',
    title: 'A worst case at a discontinuity',
    danger: 'The avoidance switches, and the distance jumps: next to the worst case the flight is a different one.',
    answer:
      'Parameters are stored at full precision. A few hundred neighbours of every finding are evaluated, the lowest takes its place, and this is repeated until nothing lower is stored.',
  },
  {
    id: 'noise',
    title: 'One realisation of the noise, or the mean of several',
    danger: 'A search with one noise seed finds the worst case of that seed; in a mean a single violation disappears.',
    answer:
      'With noise the sample draws a new realisation for every evaluation. Means are not cleared, nor is noise without such a sample. The simulated seed is stored with every trace and finding.',
  },
  {
    id: 'excluded',
    title: 'Excluded starts',
    danger: 'Flights that start at or below the criterion, or that its own rule excludes, are excluded. If many are, the verdict holds for few.',
    answer:
      `They are counted everywhere, the statement on probability names its condition, and above ${percent(LIMITS.excluded)} the run is inconclusive.`,
  },
  {
    id: 'tails',
    title: 'Tails outside the bounds',
    danger: 'A normal distribution does not end at the bounds: what is beyond them was not simulated.',
    answer: 'The probability of the tails is added to the bound on P(violation), valid for any correlation.',
  },
  {
    id: 'surface',
    title: 'Centre or surface',
    danger: 'A distance to the centre of an obstacle looks larger than the distance to its surface.',
    answer:
      'The criterion is a component, and its description says what is measured. The run page and the report’s limits quote it. The threshold must fit it.',
  },
  {
    id: 'step',
    title: 'A step that hides the worst case',
    danger: 'With a coarse step the closest approach falls between two steps, or the integration is wrong in the same way everywhere.',
    answer:
      `The minimum is refined between steps. Nominal and findings are integrated at half the step and with the reference integrator (DOP853), which also checks up to ${LIMITS.spot_checks} random evaluations of all stages; the run page shows the median and the largest distance.`,
  },
  {
    id: 'code',
    title: 'Which code was simulated',
    danger: 'A component is changed, and results of the earlier one are shown with its description.',
    answer:
      'The campaign digest, the digest of the compiled loop, versions and the description of every component are stored with the run. The page says what is installed differently now.',
  },
  {
    id: 'frame',
    title: 'Frame and units',
    danger: 'North and east, up and down, degrees and radians: a sign that is wrong in model and criterion alike is safe.',
    answer:
      'SI units throughout, angles in radians; a unit in the campaign must be that of the component. Sentences, tables and reports name the part of a parameter, or its path, where its symbol is not unique.',
  },
]
