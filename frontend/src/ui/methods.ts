// The fixed colour and marker of every search method, the same in every table, chart and list.

export type Shape = 'square' | 'diamond' | 'triangle' | 'circle' | 'hexagon' | 'cross' | 'ring'

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
}

const OTHER_NAMES: Record<string, string> = {
  hybrid_direct: 'hybrid',
  sqp_multistart: 'sqp',
  genetic: 'ga',
  genetic_algorithm: 'ga',
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
  cross: 'M1.8 1.8l6.4 6.4M8.2 1.8l-6.4 6.4',
  ring: 'M5 1.5a3.5 3.5 0 1 0 0 7a3.5 3.5 0 1 0 0-7z',
}

export const isOpen = (shape: Shape): boolean => shape === 'cross' || shape === 'ring'
