// All methods are distinguishable: by marker shape without colour, and by colour in both themes.
import { readFileSync } from 'node:fs'
import { expect, it } from 'vitest'
import type { Catalogue, MethodEntry } from '../client'
import shipped from '../generated/methods.json'
import { learnMethods, methodLook, requestBy, OUTLINE, variables } from './methods'

const METHODS = shipped.map(({ name }) => name)
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

it('gives every method a shape and colours of its own', () => {
  expect(METHODS.length).toBeGreaterThanOrEqual(16)
  for (const of of [(m: string) => methodLook(m).shape, (m: string) => methodLook(m).colour])
    expect(new Set(METHODS.map(of)).size).toBe(METHODS.length)
  for (const theme of [0, 1]) expect(new Set(METHODS.map((m) => methodLook(m).colours?.[theme])).size).toBe(METHODS.length)
  expect(new Set(Object.values(OUTLINE)).size).toBe(Object.keys(OUTLINE).length)
})

it.each(METHODS)('shows %s at 3:1 on every ground of both themes', (method) => {
  const { colours } = methodLook(method)
  for (const [i, theme] of [LIGHT, DARK].entries())
    for (const ground of ['--surface', '--bg', '--sunken'])
      expect(contrast(colours?.[i as 0 | 1] ?? '', token(theme, ground))).toBeGreaterThanOrEqual(3)
})

it('declares the variable of every colour in both themes', () => {
  const [light = '', dark = ''] = variables(METHODS.map(methodLook)).split(':root[data-theme="dark"]')
  for (const { name, look } of shipped) {
    expect(light).toContain(`--m-${name}: ${look.colour};`)
    expect(dark).toContain(`--m-${name}: ${look.dark};`)
  }
})

it('knows the names of earlier versions', () => {
  const earlier = shipped.flatMap((method) => method.earlier.map((name) => [name, method.name] as const))
  expect(earlier.length).toBeGreaterThan(0)
  for (const [then, now] of earlier) expect(methodLook(then)).toEqual(methodLook(now))
  expect(methodLook('of_a_package')).toMatchObject({ shape: 'ring', title: 'Of a package' })
})

it('requests the catalogue once for a method that is not shipped', async () => {
  const requests: number[] = []
  requestBy(() => requests.push(1))
  METHODS.forEach(methodLook)
  methodLook(null)
  await Promise.resolve()
  expect(requests).toEqual([])
  methodLook('of_another_package')
  methodLook('of_another_package')
  await Promise.resolve()
  expect(requests).toEqual([1])
})

it('learns the methods of other packages from a catalogue', () => {
  const entry = (name: string, look?: MethodEntry['look']) => ({ name, title: name.toUpperCase(), look }) as MethodEntry
  const catalogue = (...methods: MethodEntry[]) => ({ version: '', components: [], methods }) as Catalogue
  const guess = entry('guess', { colour: '#2e8b3d', dark: '#6fcf7f', marker: 'bow', short: 'G' })
  const cma = methodLook('cma_es')
  learnMethods(catalogue(guess, entry('cma_es'), entry('plain')))
  expect(methodLook('guess')).toEqual({
    colour: '--m-guess', colours: ['#2e8b3d', '#6fcf7f'], shape: 'bow', title: 'GUESS', short: 'G',
  })
  expect(methodLook('cma_es')).toEqual(cma)
  expect(methodLook('plain')).toMatchObject({ colour: '--c-nom', shape: 'ring', title: 'PLAIN' })
  learnMethods(catalogue(entry('guess', { colour: '#6b4f00', dark: '#b59a4d', marker: 'star', short: '' })), true)
  expect(methodLook('guess').colours).toEqual(['#2e8b3d', '#6fcf7f'])
  learnMethods(catalogue(entry('guess', { colour: '#6b4f00', dark: '#b59a4d', marker: 'star', short: '' })))
  expect(methodLook('guess')).toMatchObject({ colours: ['#6b4f00', '#b59a4d'], shape: 'star', short: 'GUESS' })
})
