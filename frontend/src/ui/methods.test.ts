// All methods are distinguishable: by marker shape without colour, and by colour in both themes.
import { readFileSync } from 'node:fs'
import { expect, it } from 'vitest'
import type { Catalogue, MethodEntry } from '../client'
import { learnMethods, METHODS, methodLook, OUTLINE } from './methods'

const CSS = readFileSync(new URL('../theme/tokens.css', import.meta.url), 'utf8')
const [LIGHT = '', DARK = ''] = CSS.split(':root[data-theme="dark"]')

const token = (theme: string, name: string): string => new RegExp(`${name}: (#[0-9a-f]+);`).exec(theme)?.[1] ?? name

/** Relative luminance, WCAG 2.2. */
function luminance(hex: string): number {
  const long = hex.length === 4 ? hex.replace(/[0-9a-f]/g, '$&$&') : hex
  const [r = 0, g = 0, b = 0] = [1, 3, 5].map((at) => {
    const c = Number.parseInt(long.slice(at, at + 2), 16) / 255
    return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4
  })
  return 0.2126 * r + 0.7152 * g + 0.0722 * b
}

function contrast(a: string, b: string): number {
  const [high = 0, low = 0] = [luminance(a), luminance(b)].sort((x, y) => y - x)
  return (high + 0.05) / (low + 0.05)
}

it('gives every method a shape and a colour of its own', () => {
  expect(METHODS).toHaveLength(16)
  for (const of of [(m: string) => methodLook(m).shape, (m: string) => methodLook(m).colour])
    expect(new Set(METHODS.map(of)).size).toBe(METHODS.length)
  expect(new Set(Object.values(OUTLINE)).size).toBe(Object.keys(OUTLINE).length)
})

it.each(METHODS)('shows %s at 3:1 on every ground of both themes', (method) => {
  const { colour } = methodLook(method)
  for (const theme of [LIGHT, DARK])
    for (const ground of ['--surface', '--bg', '--sunken'])
      expect(contrast(token(theme, colour), token(theme, ground))).toBeGreaterThanOrEqual(3)
})

it('knows the names that campaigns use', () => {
  const names = ['genetic', 'hybrid_direct', 'global_clustering', 'sqp_multistart', 'monte_carlo']
  expect(names.map((name) => methodLook(name).shape)).toEqual(['circle', 'diamond', 'hexagon', 'triangle', 'cross'])
  expect(methodLook('of_a_package')).toMatchObject({ shape: 'ring', title: 'Of a package' })
})

it('learns the methods of other packages from a catalogue', () => {
  const entry = (name: string, look?: MethodEntry['look']) => ({ name, title: name.toUpperCase(), look }) as MethodEntry
  const catalogue = (...methods: MethodEntry[]) => ({ version: '', components: [], methods }) as Catalogue
  const guess = entry('guess', { colour: 'extra-2', marker: 'bow', short: 'G' })
  const cma = methodLook('cma_es')
  learnMethods(catalogue(guess, entry('cma_es'), entry('plain')))
  expect(methodLook('guess')).toEqual({ colour: '--m-extra-2', shape: 'bow', title: 'GUESS', short: 'G' })
  expect(methodLook('cma_es')).toEqual(cma)
  expect(methodLook('plain')).toMatchObject({ colour: '--c-nom', shape: 'ring', title: 'PLAIN' })
  learnMethods(catalogue(entry('guess', { colour: 'extra-1', marker: 'star', short: '' })), true)
  expect(methodLook('guess').colour).toBe('--m-extra-2')
  learnMethods(catalogue(entry('guess', { colour: 'extra-1', marker: 'star', short: '' })))
  expect(methodLook('guess')).toMatchObject({ colour: '--m-extra-1', shape: 'star', short: 'GUESS' })
})

it.each(['extra-1', 'extra-2', 'extra-3'])('shows the colour %s at 3:1 on every ground of both themes', (name) => {
  for (const theme of [LIGHT, DARK])
    for (const ground of ['--surface', '--bg', '--sunken'])
      expect(contrast(token(theme, `--m-${name}`), token(theme, ground))).toBeGreaterThanOrEqual(3)
})
