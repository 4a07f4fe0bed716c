// The probability that independent samples miss a small set of violations, for the help table.

export const SLITS = [1e-3, 1e-4, 1e-5] as const
export const SAMPLES = [1000, 3000, 10000] as const

/** The probability that n independent samples all miss a set of probability p: (1 - p)^n. */
export const missed = (p: number, n: number): number => Math.exp(n * Math.log1p(-p))
