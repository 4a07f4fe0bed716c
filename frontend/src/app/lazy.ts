// The code of the most frequent pages; that for an address can be requested before the router runs.
import { inside } from '../format/root'

export const lazy = {
  runs: () => import('../runs/RunsPage'),
  run: () => import('../run/RunPage'),
  flight: () => import('../run/FlightPage'),
  launch: () => import('../launch/LaunchPage'),
  compare: () => import('../compare/ComparePage'),
}

/** The code of the page at an address, if it is one of these. */
export function pageAt(address: string): (() => Promise<unknown>) | undefined {
  const path = inside(address)
  if (/^\/runs\/[^/]+\/flight\/?$/.test(path)) return lazy.flight
  if (path.startsWith('/runs/')) return lazy.run
  return { '/': lazy.runs, '/runs': lazy.runs, '/launch': lazy.launch, '/compare': lazy.compare }[path]
}
