// The fixed colour and marker of every search method, the same in every table, chart and list.

export type Shape =
  | 'square'
  | 'box'
  | 'diamond'
  | 'triangle'
  | 'down'
  | 'right'
  | 'circle'
  | 'hexagon'
  | 'pentagon'
  | 'star'
  | 'plus'
  | 'bow'
  | 'asterisk'
  | 'cross'
  | 'ring'

export interface MethodLook {
  /** The CSS variable of the colour. */
  colour: string
  shape: Shape
  title: string
  short: string
}

const LOOKS: Record<string, MethodLook> = {
  direct: { colour: '--m-direct', shape: 'square', title: 'DIRECT', short: 'DIRECT' },
  hybrid: { colour: '--m-hybrid', shape: 'diamond', title: 'Hybrid DIRECT', short: 'H-DIRECT' },
  sqp: { colour: '--m-sqp', shape: 'triangle', title: 'SQP multistart', short: 'SQP' },
  ga: { colour: '--m-ga', shape: 'circle', title: 'Genetic algorithm', short: 'GA' },
  global: { colour: '--m-global', shape: 'hexagon', title: 'GLOBAL', short: 'GLOBAL' },
  mc: { colour: '--m-mc', shape: 'cross', title: 'Monte Carlo', short: 'MC' },
  contrast_racing: { colour: '--m-racing', shape: 'star', title: 'Contrast racing', short: 'Racing' },
  portfolio: { colour: '--m-portfolio', shape: 'asterisk', title: 'Portfolio', short: 'Portfolio' },
  cma_es: { colour: '--m-cma', shape: 'pentagon', title: 'CMA-ES', short: 'CMA-ES' },
  differential_evolution: { colour: '--m-de', shape: 'down', title: 'Differential evolution', short: 'DE' },
  mlsl: { colour: '--m-mlsl', shape: 'right', title: 'MLSL', short: 'MLSL' },
  nlopt_global: { colour: '--m-nlopt', shape: 'plus', title: 'NLopt global', short: 'NLopt' },
  direct_l: { colour: '--m-direct-l', shape: 'box', title: 'DIRECT-L', short: 'DIRECT-L' },
  nsga2: { colour: '--m-nsga2', shape: 'bow', title: 'NSGA-II', short: 'NSGA-II' },
}

const OTHER_NAMES: Record<string, string> = {
  hybrid_direct: 'hybrid',
  sqp_multistart: 'sqp',
  genetic: 'ga',
  genetic_algorithm: 'ga',
  global_clustering: 'global',
  monte_carlo: 'mc',
}

const sentence = (name: string): string => {
  const words = name.replaceAll('_', ' ')
  return words.charAt(0).toUpperCase() + words.slice(1)
}

/** How a method looks; a stage that is no search has a grey ring. */
export function methodLook(name: string | null | undefined): MethodLook {
  const key = name ? (OTHER_NAMES[name] ?? name) : ''
  return LOOKS[key] ?? { colour: '--c-nom', shape: 'ring', title: sentence(name ?? ''), short: sentence(name ?? '') }
}

/** The outline of a marker in a box of 10 by 10, as SVG path data. */
export const OUTLINE: Record<Shape, string> = {
  square: 'M1.5 1.5h7v7h-7z',
  diamond: 'M5 .4 9.6 5 5 9.6.4 5z',
  triangle: 'M5 .8 9.6 8.9H.4z',
  circle: 'M5 1a4 4 0 1 0 0 8a4 4 0 1 0 0-8z',
  hexagon: 'M2.7 1h4.6L9.6 5 7.3 9H2.7L.4 5z',
  pentagon: 'M5 .4 9.6 3.8 7.9 9.1H2.1L.4 3.8z',
  down: 'M5 9.2.4 1.1h9.2z',
  right: 'M9.2 5 1.1.4v9.2z',
  star: 'M5 0l1.4 3.3 3.6.3-2.7 2.4.8 3.5L5 7.7 1.9 9.5l.8-3.5L0 3.6l3.6-.3z',
  plus: 'M3.5.7h3v2.8h2.8v3H6.5v2.8h-3V6.5H.7v-3h2.8z',
  bow: 'M.7.9h8.6L5.9 5l3.4 4.1H.7L4.1 5z',
  box: 'M1.7 1.7h6.6v6.6H1.7z',
  asterisk: 'M5 .5v9M1.1 2.75l7.8 4.5M8.9 2.75l-7.8 4.5',
  cross: 'M1.8 1.8l6.4 6.4M8.2 1.8l-6.4 6.4',
  ring: 'M5 1.5a3.5 3.5 0 1 0 0 7a3.5 3.5 0 1 0 0-7z',
}

const OPEN: readonly Shape[] = ['cross', 'ring', 'box', 'asterisk']

export const isOpen = (shape: Shape): boolean => OPEN.includes(shape)

/** Every method that has a look of its own. */
export const METHODS: readonly string[] = Object.keys(LOOKS)
