// A run that earlier rules cleared: the verdict in words and the number of its checks state it.
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it } from 'vitest'
import { run } from '../../../tests/fixtures'
import { words } from '../../format/spans'
import { headlineOf, wordOf } from '../../ui/VerdictBadge'
import { Checks } from './Banner'

const check = { code: 'nominal', name: 'nominal', title: 'Nominal', standing: 'holds', ok: true, statement: [words('it holds')], limit: [], text: '', but: '', values: {} } as const

it.each([
  [false, false, 'Cleared'],
  [true, false, 'Cleared: earlier rules'],
  [true, true, 'Cleared: not sampled, earlier rules'],
])('with earlier rules %s and not sampled %s reads %s', (earlier_rules, not_sampled, stated) => {
  const of = run({ verdict: 'cleared', earlier_rules, not_sampled })
  expect(wordOf(of)).toBe(stated)
  expect(headlineOf(of)).toBe(stated.replace('C', 'c'))
  expect(wordOf(run({ state: 'running', verdict: null, earlier_rules }))).toBe('Running')
})

it.each([
  [false, 'All 1 checks hold'],
  [true, 'All 1 checks of that version hold'],
])('counts checks with earlier rules %s', (earlier, stated) => {
  const shown = renderToStaticMarkup(<Checks checks={[{ ...check, statement: [...check.statement], limit: [], remedies: [] }]} succeeded={3} earlier={earlier} />)
  expect(shown).toContain(stated)
})
