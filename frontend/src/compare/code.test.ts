// When two runs of one campaign are reported as run by different code.
import { describe, expect, it } from 'vitest'
import type { Versions } from '../client'
import { changedComponents, codeRows, sameCampaignOtherCode } from './code'

const flown: Versions = {
  system: 'Linux x86_64',
  lanes: 8,
  step: 0.005,
  integrator: 'RK4',
  code: 'a'.repeat(64),
  loop: '0123456789abcdef',
  packages: { numpy: '2.4.6', scipy: '1.17.1' },
  clearance: '0.1.0',
  python: '3.11.7',
  cpu: { model: 'A CPU', target: 'znver4', features: '' },
}
const run = (changes: Partial<Versions> | null = {}, campaign = 'one') => ({
  campaign_digest: campaign,
  flown: changes && { ...flown, ...changes },
})
const differing = (...runs: ReturnType<typeof run>[]) =>
  codeRows(runs)
    .filter((row) => row.differs)
    .map((row) => [row.key, ...row.values])

describe('the versions', () => {
  it('are listed row by row, and differences are marked', () => {
    const other = run({ code: 'b'.repeat(64), packages: { numpy: '2.5.0', scipy: '1.17.1' } })
    expect(differing(run(), other)).toEqual([
      ['code', 'a'.repeat(64), 'b'.repeat(64)],
      ['packages.numpy', '2.4.6', '2.5.0'],
    ])
    expect(differing(run(), run())).toEqual([])
  })
  it('name the own components whose files are not the same', () => {
    const one = run({ components: { 'my_way.py': 'a', 'my_robot.py': 'b' } })
    const other = run({ components: { 'my_way.py': 'c', 'my_robot.py': 'b' } })
    expect(changedComponents([one, other])).toEqual(['components/my_way.py'])
    expect(sameCampaignOtherCode([one, other])).toBe(true)
    expect(changedComponents([one, one])).toEqual([])
    expect(changedComponents([one, run()])).toEqual([])
  })
  it('is different code for every part that may change a number', () => {
    for (const change of [{ code: 'b' }, { loop: 'c' }, { python: '3.12.1' }, { packages: { numpy: '2.5.0' } }])
      expect(sameCampaignOtherCode([run(), run(change)])).toBe(true)
  })
  it('is not different code of another campaign, on another processor or where nothing was stored', () => {
    expect(sameCampaignOtherCode([run(), run()])).toBe(false)
    expect(sameCampaignOtherCode([run(), run({ code: 'b' }, 'two')])).toBe(false)
    expect(sameCampaignOtherCode([run(), run({ cpu: { model: 'B', target: 'x', features: '' } })])).toBe(false)
    expect(sameCampaignOtherCode([run(), run(null)])).toBe(false)
    expect(codeRows([run(), run(null)])[0]?.values).toEqual(['a'.repeat(64), undefined])
  })
  it('sees two of one campaign among others', () => {
    expect(sameCampaignOtherCode([run({}, 'two'), run(), run({ loop: 'c' })])).toBe(true)
  })
})
