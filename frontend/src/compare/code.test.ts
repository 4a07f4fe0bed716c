// When two runs of one campaign are reported as run by different code.
import { describe, expect, it } from 'vitest'
import type { Identity, Versions } from '../client'
import { changedFiles, codeRows, otherCode, otherCodeText } from './code'

const flown: Versions = {
  system: 'Linux x86_64',
  lanes: 8,
  step: 0.005,
  integrator: 'RK4',
  code: 'a'.repeat(64),
  loop: '0123456789abcdef',
  packages: {},
  clearance: '0.1.0',
  python: '3.11.7',
  cpu: { model: 'A CPU', target: 'znver4', features: '' },
}
const identity: Identity = {
  engine: 'a'.repeat(64),
  evaluating: 'e'.repeat(64),
  loop: '0123456789abcdef',
  files: {},
  packages: { Python: '3.11.7', numpy: '2.4.6', scipy: '1.17.1' },
  machine: 'Linux x86_64, znver4',
  unidentified: [],
  digest: 'd'.repeat(64),
}
const run = (changes: Partial<Identity> | null = {}, campaign = 'one', versions: Partial<Versions> = {}) => ({
  campaign_digest: campaign,
  flown: changes && { ...flown, ...versions },
  identity: changes && { ...identity, ...changes },
})
const differing = (...runs: ReturnType<typeof run>[]) =>
  codeRows(runs)
    .filter((row) => row.differs)
    .map((row) => [row.key, ...row.values])

const isOther = (runs: ReturnType<typeof run>[]) => otherCode(runs) !== null

describe('the versions', () => {
  it('are listed row by row, and differences are marked', () => {
    const other = run({ engine: 'b'.repeat(64), packages: { ...identity.packages, numpy: '2.5.0' } })
    expect(differing(run(), other)).toEqual([
      ['engine', 'a'.repeat(64), 'b'.repeat(64)],
      ['packages.numpy', '2.4.6', '2.5.0'],
    ])
    expect(differing(run(), run())).toEqual([])
  })
  it('name the own files that are not the same', () => {
    const one = run({ files: { 'components/my_way.py': 'a', 'components/my_robot.py': 'b' } })
    const other = run({ files: { 'components/my_way.py': 'c', 'components/my_robot.py': 'b' } })
    expect(changedFiles([one, other])).toEqual(['components/my_way.py'])
    expect(isOther([one, other])).toBe(true)
    expect(otherCodeText(one, other, [])).toBe('Same campaign, different code: components/my_way.py.')
    expect(changedFiles([one, one])).toEqual([])
    expect(changedFiles([one, run()])).toEqual([])
  })
  it('is different code for every part that may change a number', () => {
    const each: Partial<Identity>[] = [{ engine: 'b' }, { loop: 'c' }, { packages: { Python: '3.12.1' } }, { packages: { numpy: '2.5.0' } }]
    for (const change of each)
      expect(isOther([run(), run(change)])).toBe(true)
  })
  it('is not different code of another campaign, on another processor or where nothing was stored', () => {
    expect(isOther([run(), run()])).toBe(false)
    expect(isOther([run(), run({ engine: 'b' }, 'two')])).toBe(false)
    expect(isOther([run(), run({}, 'one', { cpu: { model: 'B', target: 'x', features: '' } })])).toBe(false)
    expect(isOther([run(), run(null)])).toBe(false)
    expect(codeRows([run(), run(null)])[0]?.values).toEqual(['d'.repeat(64), undefined])
  })
  it('sees two of one campaign among others', () => {
    expect(isOther([run({}, 'two'), run(), run({ loop: 'c' })])).toBe(true)
  })
  it('has a row for the step and the integrator, as they were run', () => {
    const rows = Object.fromEntries(codeRows([run(), run({}, 'one', { step: 0.01 })]).map((row) => [row.name, row]))
    expect(rows['Step']).toMatchObject({ values: ['5 ms', '10 ms'], differs: true })
    expect(rows['Integrator']).toMatchObject({ values: ['RK4', 'RK4'], differs: false })
    expect([rows['Code']?.digest, rows['Compiled loop']?.digest]).toEqual([true, true])
  })
})

describe('different code of one campaign', () => {
  const file = (name: string, change: 'changed' | 'added' = 'changed') => ({ file: name, change, component: null })
  it('is a sentence of its own that names the files', () => {
    const [a, b] = [run(), run({ engine: 'b'.repeat(64) })]
    expect(otherCodeText(a, b, [file('worker/engine/components/avoiders/ge_cui.py'), file('worker/engine/physics/new.py', 'added')])).toBe(
      'Same campaign, different code: worker/engine/components/avoiders/ge_cui.py, worker/engine/physics/new.py (added).',
    )
    expect(otherCodeText(a, b, ['1', '2', '3', '4', '5', '6'].map((name) => file(name)))).toContain('1, 2, 3, 4 and 2 more files.')
    expect(otherCodeText(a, b, null)).toBe('Same campaign, different code: source files whose names are not stored.')
    expect(otherCodeText(a, b, undefined)).toContain('could not be loaded')
  })
  it('is also another package, or another compiled loop of the same sources', () => {
    expect(otherCodeText(run(), run({ packages: { ...identity.packages, numpy: '2.5.0' } }), [])).toBe('Same campaign, different code: numpy 2.4.6 and 2.5.0.')
    expect(otherCodeText(run(), run({ loop: 'beef' }), [])).toBe('Same campaign, different code: the compiled loop.')
  })
})
