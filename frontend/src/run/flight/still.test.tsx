// What stands in place of the 3D view where the processor would draw it.
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it } from 'vitest'
import { flight, head } from '../../../tests/fixtures'
import { counted } from '../../api/queries'
import type { RunData } from '../data/data'
import { Still } from './Still'

const shown = (data: object) => renderToStaticMarkup(<Still data={data as RunData} onOpen={() => undefined} />)

it('draws the flights from above, and offers the view', () => {
  const nominalTrace = flight({})
  const text = shown({ campaign: { scenario: { horizon: 10 } }, run: { summary: null }, chosen: 'F1', nominalTrace, findingTrace: nominalTrace })
  expect(text).toContain('<svg')
  expect(text).toContain('Seen from above')
  expect(text).toContain('Open in 3D</button>')
})

it('draws no picture of a system whose columns are its own', () => {
  const text = shown({ campaign: { simulator: { name: 's' } }, run: { summary: null }, chosen: 'F1', nominalTrace: flight({}) })
  expect(text).not.toContain('Seen from above')
  expect(text).toContain('Open in 3D</button>')
})

it('has no closest approach of a flight that failed', () => {
  const closest = { time: 1, row: 3, value: 5.6376, position: [0, 0, 0], speed: null, obstacle: 0, obstacle_position: [5.6, 0, 0] }
  expect(counted({ meta: head({ closest }) }).meta.closest).toEqual(closest)
  for (const status of ['failed', 'timeout', 'excluded'] as const)
    expect(counted({ meta: head({ closest, status }) }).meta.closest).toBeNull()
})
