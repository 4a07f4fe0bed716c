// Other runs that speak against a verdict: the sentence names few, all are on demand, and the list of runs marks the verdict.
import { createMemoryHistory, createRootRoute, createRoute, createRouter, RouterContextProvider } from '@tanstack/react-router'
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it } from 'vitest'
import { run } from '../../../tests/fixtures'
import { headlineOf, RunBadge, wordOf } from '../../ui/VerdictBadge'
import { Against } from './Banner'

const ids = ['R-0001', 'R-0002', 'R-0003', 'R-0004', 'R-0005']
const against = 'R-0001, R-0002, R-0003 and 2 more violate the criterion.'

it('lists all runs on demand where the sentence does not name them', async () => {
  const root = createRootRoute()
  const page = createRoute({ getParentRoute: () => root, path: '/runs/$run' })
  const router = createRouter({ routeTree: root.addChildren([page]), history: createMemoryHistory(), isServer: true })
  await router.load()
  const shown = (all: string[], sentence = against) =>
    renderToStaticMarkup(
      <RouterContextProvider router={router as never}>
        <Against run={run({ verdict: 'cleared', against: sentence, against_runs: all })} />
      </RouterContextProvider>,
    )
  expect(shown(ids)).toContain('<summary>All 5 runs</summary>')
  expect(shown(ids)).toContain('>R-0005</a>')
  expect(shown(ids.slice(0, 3))).not.toContain('<details')
  const longer = ['R-1000', 'R-10001', 'R-10002', 'R-10003'] // the first is the beginning of another one
  expect(shown(longer, 'R-10001, R-10002, R-10003 and 1 more violate the criterion.')).toContain('>R-1000</a>')
  expect(renderToStaticMarkup(<Against run={run({ verdict: 'cleared' })} />)).toBe('')
})

it('marks the verdict of a row with the sentence', () => {
  const of = run({ verdict: 'cleared', against })
  const shown = renderToStaticMarkup(<RunBadge run={of} />)
  expect(shown).toContain(`title="${against}"`)
  expect(shown).toContain('Cleared: contradicted')
  expect(shown).toContain('data-tone="unk"') // and no tick
  expect([wordOf(of), headlineOf({ ...of, not_sampled: true })]).toEqual(['Cleared: contradicted', 'cleared: not sampled, contradicted'])
  expect(renderToStaticMarkup(<RunBadge run={run({ verdict: 'cleared' })} />)).not.toContain('title')
})
