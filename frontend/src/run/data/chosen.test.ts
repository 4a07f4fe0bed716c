// Choices in the address, and the fallback for missing ones.
import { expect, it } from 'vitest'
import type { RunDetail } from '../../client'
import { finding } from '../../../tests/fixtures'
import { calledOf, chosenOf, readChosen, worstOf } from './chosen'

const found = (...labels: string[]) => labels.map((label) => finding(label))

it('reads labels and the nominal flight, nothing else', () => {
  for (const finding of ['F1', 'F12', 'nominal']) expect(readChosen({ finding })).toEqual({ finding })
  for (const finding of ['F0', 'f1', 'worst', '', 7, null]) expect(readChosen({ finding })).toEqual({})
})

it('reads ranges, one or several', () => {
  expect(readChosen({ brush: 'vehicle.m:4:-5e-7' })).toEqual({ brush: ['vehicle.m:4:-5e-7'] })
  expect(readChosen({ finding: 'F2', brush: ['value:0:1', 'm', 7, 'a:1'] })).toEqual({ finding: 'F2', brush: ['value:0:1'] })
  expect(readChosen({ brush: true })).toEqual({})
})

it('reads an instant and a camera', () => {
  expect(readChosen({ finding: 'F2', t: '27.18', cam: 'encounter' })).toEqual({ finding: 'F2', t: 27.18, cam: 'encounter' })
  expect(readChosen({ t: 0 })).toEqual({ t: 0 })
  for (const t of ['', '-1', 'nan', 'soon', '1e9', true]) expect(readChosen({ t, cam: 'behind' })).toEqual({})
})

it('reads what colours the parameter space, how much of the flight, and which columns', () => {
  expect(readChosen({ by: 'goal_miss#2', time: 'all', columns: 'u,p_demand' })).toEqual({
    by: 'goal_miss#2',
    time: 'all',
    columns: 'u,p_demand',
  })
  expect(readChosen({ by: 'a b', time: 'some', columns: 'u,,p' })).toEqual({})
  expect(readChosen({ brush: 'goal_miss#2:1:2' })).toEqual({ brush: ['goal_miss#2:1:2'] })
})

it('shows the worst unless another one is known', () => {
  expect(chosenOf(undefined, found('F1', 'F2'), 'F1')).toBe('F1')
  expect(chosenOf('F2', found('F1', 'F2'), 'F1')).toBe('F2')
  expect(chosenOf('F9', found('F1', 'F2'), 'F1')).toBe('F1')
  expect(chosenOf('nominal', found('F1'), 'F1')).toBe('nominal')
  // While the findings are loading, the requested one is kept.
  expect(chosenOf('F2', [], 'F1')).toBe('F2')
  expect(chosenOf(undefined, [], 'F1')).toBe('F1')
})

it('calls the finding of the verdict the worst, and shows it', () => {
  const named = { summary: { worst: { finding: 'F2' } } } as Pick<RunDetail, 'summary'>
  const called = (run: Pick<RunDetail, 'summary'>) => ['F1', 'F2'].map((chosen) => calledOf({ run, chosen }))
  expect(called(named)).toEqual(['F1', 'Worst'])
  expect(called({ summary: null })).toEqual(['Worst', 'F2'])
  expect(chosenOf(undefined, found('F1', 'F2'), worstOf(named))).toBe('F2')
})
