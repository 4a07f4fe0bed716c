// The settings of a campaign that belong to no component: location, unit, description. Names and limits are those of the
// service, which reports errors next to the field.
import { DEFAULTS } from '../../api/rules'
import { type Campaign, type Raw, read } from '../../api/campaign'

export interface Setting {
  at: (string | number)[]
  label: string
  unit?: string
  text: string
  /** The default if left empty, which may depend on whether its stage is asked for. */
  empty?: string | ((campaign: Campaign) => string)
  /** Left empty, it alone is removed, not its stage or study. */
  alone?: true
  /** What may be chosen, the default first. */
  choices?: { value: string; label: string }[]
}

export const SIMULATION: Setting[] = [
  { at: ['scenario', 'horizon'], label: 'Horizon', unit: 's', text: 'Duration of a simulation' },
  { at: ['scenario', 'step'], label: 'Step', unit: 's', text: 'Of the fourth-order Runge-Kutta method' },
  {
    at: ['scenario', 'guidance', 'period'],
    label: 'Guidance period',
    unit: 's',
    text: '0: the avoider is evaluated continuously; otherwise at this period, with a zero-order hold',
  },
]

export const VERDICT: Setting[] = [
  { at: ['agreement'], label: 'Agreement', text: 'Fraction of nominal minus worst within which the global methods must agree, and within a tenth of the margin' },
  {
    at: ['target_probability'],
    label: 'Target for P(violation)',
    text: 'The upper bound from the certify stage must meet it',
    empty: 'none',
  },
  { at: ['confidence'], label: 'Confidence', text: 'Of every statement on a probability' },
  { at: ['seed'], label: 'Seed', text: 'Of all random numbers but those of the independent sample and the estimate, whose seed is drawn at launch' },
]

export interface Group {
  /** The name of the stage. */
  title: string
  digest: (campaign: Campaign) => string
  settings: Setting[]
}

const words = (count: Raw | null | undefined, one: string): string => `${count ?? ''} ${one}`

export const STAGES: Group[] = [
  {
    title: 'Certify',
    digest: ({ stages: { certify } }) =>
      certify
        ? [
            words(certify.samples ?? DEFAULTS.samples, 'random samples'),
            certify.keep === 'lowest' && 'the lowest stored',
            certify.until === 'target' && 'until the target',
            certify.grid && 'full grid',
          ]
            .filter(Boolean)
            .join(', ')
        : 'none: not cleared',
    settings: [
      {
        at: ['stages', 'certify', 'samples'],
        label: 'Certify samples',
        text: 'Independent samples, without which nothing is cleared; empty draws none',
        empty: 'omitted',
      },
      {
        at: ['stages', 'certify', 'quantile'],
        label: 'Certify quantile',
        text: 'Fraction of the samples whose value is bounded from below',
      },
      {
        at: ['stages', 'certify', 'keep'],
        label: 'Stored flights',
        text: 'Of a large sample, the lowest and the first, with counts of all: any of them can be simulated again',
        choices: [
          { value: 'all', label: 'All' },
          { value: 'lowest', label: 'The lowest 1 000 and the first 1 024' },
        ],
      },
      {
        at: ['stages', 'certify', 'until'],
        label: 'It ends',
        text: 'Early only if the lowest are stored and there is a target for P(violation)',
        choices: [
          { value: 'samples', label: 'With its last sample' },
          { value: 'target', label: 'When more violate than the target allows' },
        ],
      },
      {
        at: ['stages', 'certify', 'grid', 'points'],
        label: 'Grid points per axis',
        text: 'A full grid, for few parameters; empty omits it',
        empty: 'omitted',
      },
    ],
  },
  {
    title: 'Estimate',
    digest: ({ stages: { estimate } }) => (estimate ? words(estimate.evaluations, 'evaluations over the modes of violations') : 'omitted'),
    settings: [
      {
        at: ['stages', 'estimate', 'evaluations'],
        label: 'Estimate evaluations',
        text: 'Estimates a small P(violation) from the violations that were found; empty omits it',
        empty: 'omitted',
      },
    ],
  },
  {
    title: 'Attraction',
    digest: ({ stages: { attraction } }) => (attraction ? 'region of attraction about trim' : 'omitted'),
    settings: [
      {
        at: ['stages', 'attraction', 'degree'],
        label: 'Degree of V',
        text: 'Proves a region from which the loop returns to its trim, for its polynomial model; degree 2 takes seconds, degree 4 minutes, and 6 is the default for two states; empty omits it',
        empty: ({ stages: { attraction } }) => (attraction ? 'by the number of states' : 'omitted'),
      },
    ],
  },
  {
    title: 'Sensitivity',
    digest: ({ stages: { sensitivity } }) =>
      sensitivity
        ? [
            words(sensitivity.points, 'points per parameter'),
            sensitivity.morris && 'Morris',
            sensitivity.sobol && 'Sobol',
          ]
            .filter(Boolean)
            .join(', ')
        : 'omitted',
    settings: [
      {
        at: ['stages', 'sensitivity', 'points'],
        label: 'Sensitivity points',
        text: 'Per parameter, one at a time; empty omits the stage',
        empty: 'omitted',
      },
      {
        at: ['stages', 'sensitivity', 'morris', 'trajectories'],
        label: 'Morris trajectories',
        text: 'Elementary effects over the whole box; empty omits them',
        empty: 'omitted',
      },
      { at: ['stages', 'sensitivity', 'morris', 'levels'], label: 'Morris levels', text: 'Of the grid; an even number' },
      {
        at: ['stages', 'sensitivity', 'sobol', 'samples'],
        label: 'Sobol samples',
        text: 'Fractions of the variance; a power of two; empty omits them',
        empty: 'omitted',
      },
    ],
  },
  {
    title: 'Findings',
    digest: ({ stages: { findings } }) => `at most ${findings?.at_most ?? DEFAULTS.at_most} distinct worst cases`,
    settings: [
      { at: ['stages', 'findings', 'at_most'], label: 'Findings at most', text: 'Maximum number of distinct worst cases' },
      {
        at: ['stages', 'findings', 'evaluations'],
        label: 'Evaluations at most',
        text: 'For distinguishing worst cases; with the usual 20 000, validation takes at most as many as the searches',
      },
      {
        at: ['stages', 'findings', 'distance'],
        label: 'Distance',
        text: 'Two minima closer than this fraction of every range count as one; with a baseline, this is at most 0.05',
      },
      {
        at: ['stages', 'findings', 'barrier'],
        label: 'Barrier',
        text: 'Two minima count as one if no barrier between them is above this fraction of nominal minus worst',
      },
    ],
  },
  {
    title: 'Validate',
    digest: ({ stages: { validate } }) =>
      `tolerance ${validate?.tolerance ?? ''}, ${words(validate?.neighbours, 'neighbours of each finding')}`,
    settings: [
      {
        at: ['stages', 'validate', 'tolerance'],
        label: 'Validation tolerance',
        text: 'Fraction of the value, for the step-halving check and the reference integrator',
      },
      { at: ['stages', 'validate', 'neighbours'], label: 'Neighbours', text: 'Simulated around each finding' },
      { at: ['stages', 'validate', 'reach'], label: 'Range of neighbours', text: 'Fraction of each range' },
      {
        at: ['stages', 'validate', 'evaluations'],
        label: 'Evaluations in all',
        text: 'Of validation, those made again to confirm results included; empty: as many as the searches',
        empty: 'as the searches',
        alone: true,
      },
    ],
  },
]

/** Reads a setting from a campaign. */
export const settingOf = (campaign: Campaign, { at }: Setting): Raw | null =>
  (read(campaign, at) as Raw | null | undefined) ?? null

/** Writes a setting: a stage or study without its first number is removed as a whole. */
export function settled({ at, empty, alone }: Setting, value: Raw | null): [(string | number)[], Raw | null] {
  if (value === null && at[0] === 'stages' && empty !== undefined && !alone) return [at.slice(0, -1), null]
  return [at, value === null && empty === undefined ? '' : value]
}
