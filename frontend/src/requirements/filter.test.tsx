// What a filter says of requirements when some are not loaded yet: it can speak only for those that are.
import { QueryClient, QueryClientProvider } from '@tanstack/react-query'
import { createMemoryHistory, createRootRoute, createRoute, createRouter, RouterContextProvider } from '@tanstack/react-router'
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it } from 'vitest'
import { sessionQuery } from '../api/queries'
import { requirementsQuery } from '../api/requirements'
import { RequirementsPage } from './RequirementsPage'

const row = (id: string, status: string) => ({
  id, text: '', status, sentence: '', registered: true, file: null, attributes: {}, runs: [], total: 0, removed: 0, sweeps: 0, etag: '',
})

async function shown(address: string, next: string | null, ...rows: ReturnType<typeof row>[]): Promise<string> {
  const root = createRootRoute()
  const page = createRoute({ getParentRoute: () => root, path: '/requirements' })
  const router = createRouter({ routeTree: root.addChildren([page]), history: createMemoryHistory({ initialEntries: [address] }), isServer: true })
  await router.load()
  const cache = new QueryClient()
  cache.setQueryData(sessionQuery.queryKey, { role: 'engineer' } as never)
  cache.setQueryData(requirementsQuery('').queryKey, { pages: [{ items: rows, total: 250, next_cursor: next }], pageParams: [null] } as never)
  const html = renderToStaticMarkup(
    <QueryClientProvider client={cache}>
      <RouterContextProvider router={router as never}>
        <RequirementsPage />
      </RouterContextProvider>
    </QueryClientProvider>,
  )
  return html.replace(/<[^>]+>/g, '|').replace(/\|+/g, '|')
}

it('speaks only for the requirements that are loaded', async () => {
  const rows = [row('S-1', 'met'), row('S-2', 'met')]
  expect(await shown('/requirements?status=violated', 'more', ...rows)).toContain('|None of the first 2 matches. |Show all requirements|')
  expect(await shown('/requirements?status=violated', null, ...rows)).toContain('|No requirement matches. |Show all requirements|')
  const met = await shown('/requirements?status=met', 'more', ...rows)
  expect(met).toContain('|The first 2 of 250: 2 met|')
  expect(met).toContain('|Show more of 250|')
  expect(met).not.toMatch(/matches\./)
})
