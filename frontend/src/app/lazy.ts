// The pages' code, split by page; the code for an address can be requested before the router runs.
import { inside } from '../format/root'

export const lazy = {
  runs: () => import('../runs/RunsPage'),
  run: () => import('../run/RunPage'),
  flight: () => import('../run/FlightPage'),
  launch: () => import('../launch/LaunchPage'),
  compare: () => import('../compare/ComparePage'),
  trends: () => import('../trends/TrendsPage'),
  sweeps: () => import('../sweeps/SweepsPage'),
  sweep: () => import('../sweeps/SweepPage'),
  requirements: () => import('../requirements/RequirementsPage'),
  reports: () => import('../reports/ReportsPage'),
  users: () => import('../access/UsersPage'),
  tokens: () => import('../access/TokensPage'),
  sessions: () => import('../access/SessionsPage'),
  audit: () => import('../access/AuditPage'),
  docs: () => import('../docs/ApiPage'),
  verdicts: () => import('../help/VerdictsPage'),
  evidence: () => import('../help/EvidencePage'),
  methods: () => import('../help/MethodsPage'),
  components: () => import('../help/ComponentsPage'),
  guide: () => import('../help/GuidePage'),
}

/** The code of the page at an address, for the most frequent pages. */
export function pageAt(address: string): (() => Promise<unknown>) | undefined {
  const path = inside(address)
  if (/^\/runs\/[^/]+\/flight\/?$/.test(path)) return lazy.flight
  if (path.startsWith('/runs/')) return lazy.run
  return { '/': lazy.runs, '/runs': lazy.runs, '/launch': lazy.launch, '/compare': lazy.compare }[path]
}
