// The curves and best values of runs side by side: below zero too, to the end of each search, and why there is none.
import { QueryClient, QueryClientProvider } from '@tanstack/react-query'
import { act, isValidElement, type ReactElement, type ReactNode } from 'react'
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it, vi } from 'vitest'
import { finding, flight, head, progress, run } from '../../tests/fixtures'
import { Plot } from '../charts/Plot'
import type { PlotSpec } from '../charts/spec'
import type { Evaluations, StageProgress, TraceColumn } from '../client'
import { Change } from './Change'
import type { Compared } from './data'
import { FindingMargins } from './FindingMargins'
import { Methods } from './Methods'
import { Table } from '../ui/Table'
import { ConvergenceOverlay, SeparationOverlay } from './Overlays'

// Reads the theme of the document, which there is none of here.
vi.mock('../theme/useTheme', () => ({ useTheme: () => 'light' }))

const compared = (letter: string, more: Partial<Compared> = {}): Compared => ({
  id: `R-${letter}`, letter, dash: letter === 'A' ? [] : [6, 3], run: run({ id: `R-${letter}` }), stages: [], findings: [], evaluations: undefined,
  nominal: undefined, worst: undefined, catalogue: undefined, parameters: [], parts: {}, ...more,
})

/** All elements that a component returns, without rendering those within. */
const within = (node: unknown): ReactElement<Record<string, unknown>>[] => {
  if (Array.isArray(node)) return node.flatMap(within)
  return isValidElement<Record<string, unknown>>(node) ? [node, ...Object.values(node.props).flatMap(within)] : []
}
/** What a component gives the first of its elements of a type: with the hooks of a browser, but without one nothing is drawn. */
async function given(type: unknown, make: () => ReactNode) {
  const { createRoot } = await import('react-dom/client')
  const nothing = () => undefined
  const window = { HTMLIFrameElement: class {}, event: undefined }
  const page = { nodeType: 9, defaultView: window, activeElement: null, addEventListener: nothing, removeEventListener: nothing }
  vi.stubGlobal('window', window)
  vi.stubGlobal('IS_REACT_ACT_ENVIRONMENT', true)
  const root = createRoot({ ...page, nodeType: 1, tagName: 'DIV', ownerDocument: page } as never)
  let tree: ReactNode
  function Look() {
    tree = make()
    return null
  }
  act(() => root.render(<Look />))
  act(() => root.unmount())
  vi.unstubAllGlobals()
  const found = within(tree).find((element) => element.type === type)
  if (!found) throw new Error('There is no such element.')
  return found.props
}
const specOf = async (make: () => ReactNode) => (await given(Plot, make)).spec as PlotSpec
const text = (shown: ReactNode) => renderToStaticMarkup(<QueryClientProvider client={new QueryClient()}>{shown}</QueryClientProvider>).replace(/<svg.*?<\/svg>/g, '').replace(/<[^>]+>/g, ' ').replace(/\s+/g, ' ')

const column = (name: string, group: TraceColumn['group']): TraceColumn => ({ name, symbol: name, unit: 'm', group })
const flown = (separation: (number | null)[], value: number) => {
  const closest = { time: 1, row: 1, value, speed: 0, position: [0, 0, 0], obstacle: 0, obstacle_position: [0, 0, 0] }
  return flight({
    rows: separation.length, columns: [column('t', 'time'), column('d', 'separation')], meta: head({ closest }),
    data: { t: separation.map((_, i) => i), d: separation },
  })
}
const separation = async (threshold: number, ...values: (number | null)[]) => {
  const of = [compared('A', { run: run({ threshold }), worst: flown(values, Math.min(...values.map((value) => value ?? Infinity))) })]
  return (await specOf(() => SeparationOverlay({ runs: of, className: '' }))).yRange
}

it('draws separations and criteria below zero', async () => {
  expect(await separation(1, 4, 2, 3)).toEqual([0, 4.16])
  expect(await separation(1, 4, -2, 3)).toEqual([-2.08, 4.16])
  expect(await separation(-3, 4, -2, 3)).toEqual([-3.12, 4.16])
  // None is above zero.
  expect(await separation(-3, -4, null, -5)).toEqual([-5.2, 0])
})

const searched = (letter: string, stages: StageProgress[], ...best: [position: number, index: number[], cost: (number | null)[]][]) =>
  compared(letter, {
    run: run({ id: `R-${letter}`, stages }),
    evaluations: {
      criteria: [], failures: [],
      stages: best.map(([position, index, cost]) => ({ position, improvements: { index, seconds: index, cost } })),
    } as unknown as Evaluations,
  })

it('draws the best value of every search to its last evaluation, from the first that has a value', async () => {
  const runs = [
    searched('A', [progress({ method: 'direct', evaluations: 40, best: 1 })], [0, [1, 9], [3, 1]]),
    searched('B', [
      progress({ method: 'direct', evaluations: 20, best: 2 }),
      progress({ position: 1, method: 'sqp', evaluations: 7 }),
    ], [0, [0, 4], [null, 2]], [1, [], []]),
  ]
  const { x, lines } = await specOf(() => ConvergenceOverlay({ runs, className: '' }))
  expect(x).toEqual([2, 5, 10, 20, 40])
  expect(lines.map(({ key, y }) => [key, y])).toEqual([
    ['A 0', [3, 3, 1, 1, 1]],
    // A search that ended has no value afterwards; one without a value has no line.
    ['B 0', [null, 2, 2, 2, null]],
  ])
})

interface MethodTable {
  rows: unknown[]
  columns: { cell: (row: unknown) => ReactNode }[]
}

it('says why a method has no best value in a run', async () => {
  const found = [progress({ method: 'direct', best: 0.5 }), progress({ method: 'sqp', best: 0.6 }), progress({ method: 'genetic', best: 0.7 })]
  const other = [progress({ method: 'sqp', evaluations: 12 }), progress({ method: 'genetic', evaluations: 0, state: 'queued' as never })]
  const runs = [searched('A', found), searched('B', other)]
  const { rows, columns } = (await given(Table, () => Methods({ runs, className: '' }))) as unknown as MethodTable
  expect(rows.map((row) => columns.slice(1, 3).map(({ cell }) => text(cell(row)).trim()))).toEqual([
    ['0.5000', 'not run'],
    ['0.6000', 'no value'],
    ['0.7000', 'waiting'],
  ])
})

it('writes no margin as zero that is not, in the sentence and by finding', () => {
  const one = (letter: string, margin: number) =>
    compared(letter, {
      run: run({ threshold: 1, worst_cost: 1 + margin, margin }), findings: [finding('F1', { margin, parameters: { m: 5 } })],
      parameters: [{ path: 'm', symbol: 'm', unit: 'kg', text: '', nominal: 5, low: 4, high: 6 }],
    })
  const runs = [one('A', -4e-7), one('B', 1)]
  expect(text(<Change runs={runs} />)).toContain('the margin is −4e−7 m in A and +1.00')
  expect(text(<FindingMargins runs={runs} />)).toContain('F1 −4e−7 ')
})
