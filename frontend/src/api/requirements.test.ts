// Files of requirements are requested below the path of the service, such as /clearance behind a proxy.
import { afterEach, expect, test, vi } from 'vitest'
import type { RequirementFileOut } from '../client'

afterEach(() => {
  vi.unstubAllGlobals()
  vi.resetModules()
})

test('every file is below the path of the service', async () => {
  vi.resetModules() // the path is read once, perhaps by a module that another file has loaded
  vi.stubGlobal('document', { documentElement: { dataset: { root: '/clearance' } } })
  const { contentOf, EXPORTS } = await import('./requirements')
  const paths = [...EXPORTS.map(({ href }) => href), contentOf({ id: 3 } as RequirementFileOut)]
  for (const path of paths) expect(path).toMatch(/^\/clearance\/api\/v1\/requirements\//)
})
