// Texts on the traces of a simulator, and which of its columns are shown.
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it } from 'vitest'
import { flight } from '../../../tests/fixtures'
import { asCampaign } from '../../api/campaign'
import { callsOf } from '../../launch/form/Calls'
import type { RunData } from '../data/data'
import { overTime, shownColumns } from './flown'
import { Untraced } from './Untraced'

const stages = (untraced?: Record<string, string>) => [{ kind: 'nominal', result: { stage: 'nominal', cost: 1, untraced } }]
const data = (more: object) => ({ stages: stages(), traces: [], run: { summary: null, untraced: '' }, chosen: 'F1', ...more }) as unknown as RunData
const shown = (more: object) => renderToStaticMarkup(<Untraced data={data(more)} />)
const column = (name: string, group: string) => ({ name, symbol: name, unit: 'm', group })

it('states why there is no trace only if none is stored', () => {
  const none = shown({ run: { summary: null, untraced: 'It declares none.' }, stages: stages({ nominal: 'it has 1 row' }) })
  expect(none).toContain('It declares none.')
  expect(none).not.toContain('it has 1 row')
  expect(shown({ traces: [{ name: 'nominal', meta: {} }] })).toContain('This run evaluates a simulator: there is no 3D view.')
})

it('says what to declare for a 3D view, or what is drawn', () => {
  expect(shown({ traces: [{ name: 'nominal', meta: {} }] })).toContain('under <code>scene</code> which columns of the trace')
  const drawn = shown({ traces: [{ name: 'F1', meta: { scene: { frame: 'z_down' } } }] })
  expect(drawn).toContain('shows what its trace declares, z down')
  expect(drawn).not.toContain('no 3D view')
})

it('gives the reason of the nominal case and of the chosen finding', () => {
  const text = shown({ stages: stages({ nominal: 'it has 1 row', F1: 'no answer', F2: 'other' }) })
  expect(text).toContain('No trace of the nominal case: it has 1 row.')
  expect(text).toContain('No trace of Worst: no answer.')
  expect(text).not.toContain('other')
})

it('shows every column of a simulator, in its order, at first six', () => {
  const names = ['b', 'a', 'c', 'd', 'e', 'f', 'g', 'h']
  const trace = flight({ columns: [column('time', 'time'), ...names.map((name) => column(name, 'signal'))] as never })
  expect(overTime(trace).map(({ name }) => name)).toEqual(names)
  expect(shownColumns(overTime(trace), undefined).map(({ name }) => name)).toEqual(names.slice(0, 6))
  expect(shownColumns(overTime(trace), 'h').map(({ name }) => name)).toEqual(['h'])
})

it('summarises calls and retries', () => {
  const of = (simulator: object) => callsOf(asCampaign({ simulator: { name: 'drop', ...simulator } }))
  expect(of({})).toBe('one call for every evaluation')
  expect(of({ repeats: { count: 7, combine: 'mean' }, retries: 2 })).toBe(
    '7 calls for every evaluation, their average counts; a failed call is tried again up to 2 times',
  )
  expect(of({ retries: 1 })).toBe('one call for every evaluation; a failed call is tried again once')
})
