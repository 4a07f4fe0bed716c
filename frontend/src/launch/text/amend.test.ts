// Edits of the form in the texts of the library, with many comments: comments and untouched lines do not change, and
// the service's parser reads the edited campaign from the text.
import { beforeAll, expect, it } from 'vitest'
import { parse } from 'yaml'
import { type Campaign, place, write } from '../../api/campaign'
import type { Catalogue } from '../../client'
import { parametersOf } from '../campaign/parameters'
import { python, shipped, type ShippedCampaigns } from '../../../tests/repository'
import { amended } from './amend'
import { type Change, changesOf } from './changes'
import { takingOut } from './taking'

const MEANING = `
import json, sys
from campaigns import CampaignError
from campaigns.asked.load import load_document, load_text
def meaning(read, source):
    try:
        return read(source, "x").digest
    except CampaignError as error:
        return [[p.field, p.message] for p in error.problems]
pairs = json.load(sys.stdin)
print(json.dumps([[meaning(load_text, text), meaning(load_document, document)] for text, document in pairs]))
`

let catalogue: Catalogue
let campaigns: ShippedCampaigns
beforeAll(() => {
  ;({ catalogue, campaigns } = shipped())
})

/** A comment above every second line and one behind each, wherever the format has room for them. */
function commented(text: string): string {
  let inside = false
  let spread = 0
  return text
    .split('\n')
    .flatMap((line, i) => {
      if (/^\S/.test(line)) inside = false
      const bare = inside || line.trim() === ''
      if (/: [|>]$/.test(line)) inside = true
      if (bare || inside) return [line]
      const own = spread === 0 && i % 2 === 0 ? [`${/^ */.exec(line)?.[0] ?? ''}# above ${i}`] : []
      spread += (line.match(/[{[]/g) ?? []).length - (line.match(/[}\]]/g) ?? []).length
      return [...own, `${line}   # behind ${i}`]
    })
    .join('\n')
}

/** How many lines of one text are not in the other, in their order. */
function lost(before: string, after: string): number {
  const [a, b] = [before.split('\n'), after.split('\n')]
  while (a.length > 0 && a[0] === b[0]) [a, b].forEach((lines) => lines.shift())
  while (a.length > 0 && a.at(-1) === b.at(-1)) [a, b].forEach((lines) => lines.pop())
  let row = Array<number>(b.length + 1).fill(0)
  for (const line of a) {
    const next = [0]
    for (const [j, other] of b.entries())
      next.push(line === other ? (row[j] ?? 0) + 1 : Math.max(row[j + 1] ?? 0, next[j] ?? 0))
    row = next
  }
  return a.length - (row.at(-1) ?? 0)
}

type Edit = (campaign: Campaign) => Campaign | [Campaign, Change[]]
const put =
  (at: (string | number)[], value: unknown): Edit =>
  (campaign) =>
    write(campaign, at, value)

/** The edits of the form, with the number of lines that each may change. */
function edits(first: Campaign): [string, number, Edit][] {
  const parameters = parametersOf(first, catalogue)
  const some = parameters.filter(({ path }, i) => path in first.uncertain || i % 7 === 0).slice(0, 3)
  const [path = ''] = Object.keys(first.uncertain)
  const faults = first.scenario.faults ?? []
  const search = (change: (list: Campaign['stages']['search']) => Campaign['stages']['search']): Edit => (campaign) =>
    write(campaign, ['stages', 'search'], change(campaign.stages.search))
  return [
    ...some.map(({ path, nominal }): [string, number, Edit] => [path, 1, put(place(path), Number(nominal) * 1.5 + 0.125)]),
    ['a required value that is no number', 1, put(['scenario', 'horizon'], '45 s')],
    ['whole again', 1, put(['scenario', 'horizon'], first.scenario.horizon)],
    ['bounds', 1, (c) => write(c, ['uncertain', path], { ...c.uncertain[path], plus_minus: null, low: -2, high: 1e-7 })],
    ['distribution', 1, (c) => write(c, ['uncertain', path, 'distribution'], { kind: 'triangular', mode: -1.5 })],
    ['another', 1, (c) => write(c, ['uncertain', path, 'distribution'], { kind: 'beta', alpha: 2, beta: 3.5 })],
    ['held', 1, put(['uncertain', path], undefined)],
    ['varies', 0, put(['uncertain', path], { low: 0.5, high: 2, plus_minus: null, unit: null, distribution: { kind: 'uniform' } })],
    ['threshold', 1, put(['criterion', 'threshold'], 0.25)],
    ['one more obstacle', 1, (c) => write(c, ['scenario', 'obstacles'], [...(c.scenario.obstacles ?? []), { component: 'none_such', parameters: { 'position.x': 4, radius: 1 } }])],
    ['the first obstacle out', 12, (c) => takingOut(c, 'obstacles', 0)],
    ['one more fault', 1, (c) => write(c, ['scenario', 'faults'], [...(c.scenario.faults ?? []), { component: 'actuator_lag', on: 'torque', parameters: {} }])],
    ['a fault is set', 1, put(['scenario', 'faults', faults.length, 'parameters', 'tau'], 0.03)],
    ['the fault out', 4, (c) => takingOut(c, 'faults', faults.length)],
    ['another component', 3, (c) => write(write(c, ['scenario', 'avoider', 'component'], 'none'), ['scenario', 'avoider', 'parameters'], {})],
    ['a further criterion', 1, (c) => write(c, ['objectives'], [...(c.objectives ?? []), { component: 'goal_miss', parameters: {} }])],
    ['seeds', 1, put(['scenario', 'realisations', 'seeds'], [3, 4])],
    ['which counts', 1, put(['scenario', 'realisations', 'combine'], 'mean')],
    ['a budget', 1, put(['stages', 'search', 0, 'evaluations'], 77)],
    ['an option', 1, put(['stages', 'search', 0, 'options', 'iterations'], 5)],
    ['the option out', 1, put(['stages', 'search', 0, 'options', 'iterations'], undefined)],
    ['a start', 1, search((list) => list.map((one, i) => (i === 1 ? { ...one, starts: [...(one.starts ?? []), { [path]: 1.25 }] } : one)))],
    ['a method less', 14, search((list) => list.filter((_, i) => i !== 1))],
    ['a method more', 0, search((list) => list.toSpliced(1, 0, { method: 'differential_evolution', evaluations: 500, options: { sampling: 'on' }, starts: [] }))],
    ['certify out', 4, put(['stages', 'certify'], null)],
    ['certify', 1, put(['stages', 'certify', 'samples'], 400)],
    ['a grid', 1, put(['stages', 'certify', 'grid', 'points'], 5)],
    ['sensitivity out', 1, put(['stages', 'sensitivity'], null)],
    ['sensitivity', 1, put(['stages', 'sensitivity', 'points'], 11)],
    ['Morris', 1, put(['stages', 'sensitivity', 'morris', 'trajectories'], 8)],
    ['a target', 0, put(['target_probability'], 0.01)],
    ['no target', 1, put(['target_probability'], null)],
    ['a name', 1, put(['name'], 'Worst: the "second" #2')],
    ['a summary', 1, put(['summary'], 'yes')],
    ['notes', 1, (c) => write(c, ['notes'], (c.notes ?? '').replace(/\w+/, 'Once'))],
    ['a note more', 1, (c) => write(c, ['notes'], `${c.notes ?? ''}\n\nAnd so on: 1 °, # 3.`)],
    ['a published value', 0, (c) => write(c, ['published'], [...(c.published ?? []), { label: 'DIRECT, later', value: 1, at: {}, source: '' }])],
    ['its source', 1, (c) => write(c, ['published', (c.published ?? []).length - 1, 'source'], 'table 1, line 2')],
    ['a pair', 0, (c) => write(c, ['correlations'], [...(c.correlations ?? []), { between: ['vehicle.m', 'a.b'], value: 0.5 }])],
    ['the other of a pair', 1, put(['correlations', 0, 'between', 0], 'c.d')],
    ['no pair', 2, put(['correlations'], [])],
  ]
}

const own = (text: string): string[] => text.split('\n').filter((line) => /^\s*#/.test(line))

/** Each state of a text after one edit more, and the campaign that it is to mean. */
function follow(text: string, campaign: Campaign, name: string): [string, Campaign][] {
  const states: [string, Campaign][] = []
  for (const [what, touched, edit] of edits(campaign)) {
    const made = edit(campaign)
    const [next, changes] = Array.isArray(made) ? made : [made, changesOf(campaign, made)]
    const after = amended(text, changes)
    const state = `${name}: ${what}`
    expect(lost(text, after), state).toBeLessThanOrEqual(touched)
    expect(own(text).filter((line) => missing(text, line, after)), state).toEqual([])
    states.push([after, next])
    ;[text, campaign] = [after, next]
  }
  return states
}

/** Whether a comment is gone although the lines around it are not: among lines that were taken out it goes with them. */
function missing(text: string, line: string, after: string): boolean {
  const left = after.split('\n')
  if (left.includes(line)) return false
  const lines = text.split('\n')
  const at = lines.indexOf(line)
  return left.includes(lines[at - 1] ?? '') || left.includes(lines[at + 1] ?? '')
}

/** By day the form edits every fourth campaign, in `make nightly` all of them. */
const EDITED = process.env.CLEARANCE_NIGHTLY ? 1 : 4

it('touches nothing but what an edit means', () => {
  for (const [name, { text, document }] of Object.entries(campaigns))
    expect(amended(text, changesOf(document, document)), name).toBe(text)
  const some = Object.entries(campaigns).filter((_, i) => i % EDITED === 0)
  const turns = Math.min(some.length, 17)
  const states = some.flatMap(([name, { text, document }], i) => {
    const full = commented(text)
    expect(own(full).length, name).toBeGreaterThan(15)
    // The service's parser is slow: each campaign tests some of the edits, together all of them at least once.
    return follow(full, document, name).filter((_, j, all) => j % turns === i % turns || j === all.length - 1)
  })
  const meanings = python<[unknown, unknown][]>(MEANING, JSON.stringify(states))
  for (const [i, [written, meant]] of meanings.entries()) expect(written, states[i]?.[0]).toEqual(meant)
  expect(meanings.filter(([written]) => typeof written === 'string').length).toBeGreaterThan(meanings.length / 3)
})

const one = (text: string, from: unknown, to: unknown) => amended(text, changesOf(from, to))

it('writes as the text around it is written', () => {
  const text = 'name: x\nscenario:\n  horizon: 15.0  # s\n  goal: {x: 6.0, y: 7.0}\nstages: {search: []}\n'
  const first = { name: 'x', scenario: { horizon: 15, goal: { x: 6, y: 7 } }, stages: { search: [] } }
  const to = (change: object) => one(text, first, { ...first, ...change })
  expect(to({ scenario: { horizon: 20, goal: { x: 6, y: 7.5 } } })).toBe(text.replace('15.0', '20.0').replace('7.0', '7.5'))
  expect(to({ notes: 'a\nb\n' })).toBe(`${text}\nnotes: |\n  a\n  b\n`)
  expect(to({ scenario: { horizon: 15, faults: [{ component: 'f', parameters: {} }], goal: { x: 6, y: 7, z: 1 } } })).toBe(
    text.replace('# s\n', '# s\n  faults:\n    - component: f\n').replace('7.0', '7.0, z: 1'),
  )
  expect(to({ stages: { search: [{ method: 'direct', evaluations: 5, options: {} }] } })).toBe(
    text.replace('[]', '[{method: direct, evaluations: 5}]'),
  )
  const nested = 'goal:\n  position: {x: 1, y: 2}\n'
  const place = { 'position.x': 1, 'position.y': 2 }
  expect(one(nested, { goal: place }, { goal: { ...place, 'position.x': 3, 'position.z': 4 } })).toBe(
    'goal:\n  position: {x: 3, y: 2, z: 4}\n',
  )
})

it('keeps JSON as JSON and the line ends of the other system', () => {
  const json = '{\n  "name": "x",\n  "uncertain": {\n    "a.b": {"low": 1, "high": 2}\n  }\n}\n'
  const from = { name: 'x', uncertain: { 'a.b': { low: 1, high: 2 } } }
  const after = one(json, from, { name: 'y "z"', uncertain: { 'a.b': { low: 1.5, high: 2 }, 'a.c': { plus_minus: '20%' } } })
  expect(JSON.parse(after)).toEqual({ name: 'y "z"', uncertain: { 'a.b': { low: 1.5, high: 2 }, 'a.c': { plus_minus: '20%' } } })
  expect(after).toContain('    "a.b": {"low": 1.5, "high": 2},\n    "a.c"')
  const dos = 'name: x\r\nuncertain:\r\n  a.b: {low: 1} # why\r\n  a.c: {low: 1}\r\nseed: 1\r\n'
  const both = { name: 'x', uncertain: { 'a.b': { low: 1 }, 'a.c': { low: 1 } }, seed: 1 }
  const less = one(dos, both, { ...both, uncertain: { 'a.b': { low: 2 } }, agreement: 0.1 })
  expect(less).toBe('name: x\r\nuncertain:\r\n  a.b: {low: 2} # why\r\nseed: 1\r\nagreement: 0.1\r\n')
})

it('leaves text alone that it cannot read', () => {
  for (const text of ['', 'name: [', '- a\n', 'a: 1\na: 2\n', '{'])
    expect(one(text, { name: 'x' }, { name: 'y' })).toBe(text)
})

it('keeps the comments even where a place cannot be changed by itself', () => {
  const text = '# top\na:\n  - - x: 1 # first\n    - y: 2 # second\n'
  const after = one(text, { a: [[{ x: 1 }, { y: 2 }]] }, { a: [[{ y: 2 }]] })
  for (const comment of ['# top', '# second']) expect(after).toContain(comment)
})

/** A text after an edit of what it means. */
function edited<T>(text: string, edit: (document: T) => void): string {
  const [before, after] = [parse(text) as T, parse(text) as T]
  edit(after)
  return one(text, before, after)
}

it('keeps quotes, anchors, and the spaces that line comments up', () => {
  type D = { name: string; uncertain: Record<string, object>; seed?: number }
  const text = `name: 'x'  # why\n"uncertain":   # u\n  # first\n  "a.b": {low: 1, high: 2.0}   # ab\n  # second\n  'c d': &c {low: 1}\n# end\n`
  const after = edited<D>(text, (d) => Object.assign(d, { name: "it's", seed: 7, uncertain: { 'c d': { low: 3 }, e: { low: 1 } } }))
  expect(after).toBe(
    `name: 'it''s'  # why\n"uncertain":   # u\n  # first\n  # second\n  'c d': &c {low: 3}\n  e: {low: 1}\nseed: 7\n# end\n`,
  )
  expect(edited<{ a: object; b: number }>('a: &x 5   # k\nb: 1\n', (d) => (d.b = 2))).toBe('a: &x 5   # k\nb: 2\n')
  expect(edited<{ a: number; c: number }>('a: &x 1\nb: *x\nc: 1 # c\n', (d) => (d.c = 2))).toBe('a: &x 1\nb: *x\nc: 2 # c\n')
})

it('quotes what other readers would take for something else', () => {
  const values = { a: 'on', b: 'a: b', c: '\u2028 \u007f', d: ['a, b', 'c'], '5': '007', e: 'x\ny', f: '# no' }
  const after = edited<object>('%YAML 1.2\n---\na: 1 # c\n...\n', (d) => Object.assign(d, values))
  expect(parse(after)).toEqual(values)
  for (const line of ['a: "on" # c', 'c: "\\u2028 \\u007f"', 'd: ["a, b", c]', '"5": "007"']) expect(after.split('\n')).toContain(line)
  expect(after.endsWith('\n...\n')).toBe(true)
})

it('keeps the comments between braces, and the lines that entries stand on', () => {
  type D = { d: Record<string, number> }
  const text = 'd: {a: 1, # why a\n  b: 2, # why b\n  c: 3 # why c\n}\n'
  expect(edited<D>(text, (d) => delete d.d.a)).toBe('d: { # why a\n  b: 2, # why b\n  c: 3 # why c\n}\n')
  for (const key of ['b', 'c'])
    for (const comment of ['# why a', '# why b', '# why c']) {
      const after = edited<D>(text, (d) => delete d.d[key])
      expect(after).toContain(comment)
      expect(after).toMatch(key === 'b' ? /^ {2}c: 3 # why c$/m : /^ {2}b: 2/m)
    }
  expect(edited<D>(text, (d) => (d.d.e = 5))).toBe('d: {a: 1, # why a\n  b: 2, # why b\n  c: 3,\n  e: 5 # why c\n}\n')
  const lines = 'd: {\n  a: 1,\n  b: 2,\n}\n'
  expect(edited<D>(lines, (d) => delete d.d.b)).toBe('d: {\n  a: 1,\n}\n')
  expect(edited<D>(lines, (d) => (d.d.c = 3))).toBe('d: {\n  a: 1,\n  b: 2,\n  c: 3,\n}\n')
  expect(edited<D>('d: {a: 1,}\n', (d) => delete d.d.a)).toBe('d: {}\n')
})

it('keeps the comments of a list that empties and of text over several lines', () => {
  type D = { a: unknown; c: string; f?: string }
  const text = 'a: # k\n  - x: 1 # q\n    # own\n    y: 2\n  # tr\n\n# last\nc: >- # folded\n    hi\n    ho\n\ne: 5'
  const shorter = edited<{ a: { x?: number }[] }>(text, (d) => delete d.a[0]?.x)
  expect(shorter).toBe(text.replace('x: 1 # q\n    # own', '# own') + '\n')
  const after = edited<D>(text, (d) => Object.assign(d, { a: [], c: 'hi\nhu', f: 'a\nb\n' }))
  expect(after).toBe('a: [] # k\n  # tr\n\n# last\nc: |- # folded\n    hi\n    hu\n\ne: 5\n\nf: |\n  a\n  b\n')
  const dos = (unix: string) => unix.replaceAll('\n', '\r\n')
  expect(edited<D>(dos(text), (d) => Object.assign(d, { a: [], c: 'hi\nhu', f: 'a\nb\n' }))).toBe(dos(after))
})

it('puts a value of several lines behind a key, and one of a line in the place of several', () => {
  const part = { component: 'f', parameters: { tau: 1 } }
  const long = 'a: &x # k\n  component: f\n  parameters: {tau: 1}\nb: 1\n'
  expect(edited<{ a: unknown }>('a: &x 5 # k\nb: 1\n', (d) => (d.a = part)).replaceAll('  #', ' #')).toBe(long)
  expect(edited<{ a: unknown }>('a:\nb:\n\nc: 1\n', (d) => Object.assign(d, { a: 1, b: 'x\ny\n' }))).toBe('a: 1\nb: |\n  x\n  y\n\nc: 1\n')
  expect(edited<{ a: unknown }>('a: |+\n    one\n\n\nc: 1\n', (d) => (d.a = 'x'))).toContain('a: x\n')
  expect(edited<{ a: unknown }>('? a\n: 1 # c\n? b\n: 2\n', (d) => (d.a = 2))).toBe('? a\n: 2 # c\n? b\n: 2\n')
})
