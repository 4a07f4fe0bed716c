// The routes of the pages; the state of a page is in its address.
import { createRootRoute, createRoute, createRouter, lazyRouteComponent, redirect } from '@tanstack/react-router'
import { readAudit, readUsers } from '../access/search'
import { readCompare } from '../compare/search'
import { readChosen } from '../run/data/chosen'
import { readReports } from '../reports/search'
import { readRequirements } from '../requirements/search'
import { readSearch } from '../runs/search'
import { readTrend } from '../trends/search'
import { onlyKnown, parseSearch, stringifySearch } from './address'
import { lazy } from './lazy'
import { Shell } from './Shell'
import { Loading, NotFound, Trouble } from '../page/Trouble'
import { ROOT } from '../format/root'

const root = createRootRoute({ component: Shell, notFoundComponent: NotFound })

const start = createRoute({
  getParentRoute: () => root,
  path: '/',
  beforeLoad: () => {
    // oxlint-disable-next-line typescript/only-throw-error -- a redirect of the router
    throw redirect({ to: '/runs' })
  },
})

const runs = createRoute({
  getParentRoute: () => root,
  path: '/runs',
  validateSearch: onlyKnown(readSearch),
  component: lazyRouteComponent(lazy.runs, 'RunsPage'),
})

interface LaunchSearch {
  /** A campaign of the library. */
  case?: string
  /** A run to start from. */
  from?: string
  /** Changes of its campaign that its checks propose, `check.number` each, comma-separated. */
  remedy?: string
  /** A draft to be edited. */
  draft?: string
  tab?: 'yaml'
}

const word = (value: unknown): string | undefined => (typeof value === 'string' && value ? value : undefined)

const launch = createRoute({
  getParentRoute: () => root,
  path: '/launch',
  validateSearch: onlyKnown((search): LaunchSearch => ({
    case: word(search.case),
    from: word(search.from),
    remedy: word(search.remedy),
    draft: word(search.draft),
    tab: search.tab === 'yaml' ? 'yaml' : undefined,
  })),
  component: lazyRouteComponent(lazy.launch, 'LaunchPage'),
})

const run = createRoute({
  getParentRoute: () => root,
  path: '/runs/$id',
  validateSearch: onlyKnown(readChosen),
})

const runPage = createRoute({
  getParentRoute: () => run,
  path: '/',
  component: lazyRouteComponent(lazy.run, 'RunPage'),
})

/** Its 3D view in its own window. */
const flight = createRoute({
  getParentRoute: () => run,
  path: 'flight',
  component: lazyRouteComponent(lazy.flight, 'FlightPage'),
})

const docs = createRoute({
  getParentRoute: () => root,
  path: '/docs',
  component: lazyRouteComponent(lazy.docs, 'ApiPage'),
})

const verdicts = createRoute({
  getParentRoute: () => root,
  path: '/help',
  component: lazyRouteComponent(lazy.verdicts, 'VerdictsPage'),
})

const evidence = createRoute({
  getParentRoute: () => root,
  path: '/help/evidence',
  component: lazyRouteComponent(lazy.evidence, 'EvidencePage'),
})

const methods = createRoute({
  getParentRoute: () => root,
  path: '/help/methods',
  component: lazyRouteComponent(lazy.methods, 'MethodsPage'),
})

const components = createRoute({
  getParentRoute: () => root,
  path: '/help/components',
  component: lazyRouteComponent(lazy.components, 'ComponentsPage'),
})

const guide = createRoute({
  getParentRoute: () => root,
  path: '/help/guides/$name',
  component: lazyRouteComponent(lazy.guide, 'GuidePage'),
})

const compare = createRoute({
  getParentRoute: () => root,
  path: '/compare',
  validateSearch: onlyKnown(readCompare),
  component: lazyRouteComponent(lazy.compare, 'ComparePage'),
})

const trends = createRoute({
  getParentRoute: () => root,
  path: '/trends',
  validateSearch: onlyKnown(readTrend),
  component: lazyRouteComponent(lazy.trends, 'TrendsPage'),
})

const sweeps = createRoute({
  getParentRoute: () => root,
  path: '/sweeps',
  component: lazyRouteComponent(lazy.sweeps, 'SweepsPage'),
})

const sweep = createRoute({
  getParentRoute: () => root,
  path: '/sweeps/$id',
  component: lazyRouteComponent(lazy.sweep, 'SweepPage'),
})

const reports = createRoute({
  getParentRoute: () => root,
  path: '/reports',
  validateSearch: onlyKnown(readReports),
  component: lazyRouteComponent(lazy.reports, 'ReportsPage'),
})

const requirements = createRoute({
  getParentRoute: () => root,
  path: '/requirements',
  validateSearch: onlyKnown(readRequirements),
  component: lazyRouteComponent(lazy.requirements, 'RequirementsPage'),
})

const users = createRoute({
  getParentRoute: () => root,
  path: '/access/users',
  validateSearch: onlyKnown(readUsers),
  component: lazyRouteComponent(lazy.users, 'UsersPage'),
})

const tokens = createRoute({
  getParentRoute: () => root,
  path: '/access/tokens',
  component: lazyRouteComponent(lazy.tokens, 'TokensPage'),
})

const sessions = createRoute({
  getParentRoute: () => root,
  path: '/access/sessions',
  component: lazyRouteComponent(lazy.sessions, 'SessionsPage'),
})

const audit = createRoute({
  getParentRoute: () => root,
  path: '/access/audit',
  validateSearch: onlyKnown(readAudit),
  component: lazyRouteComponent(lazy.audit, 'AuditPage'),
})

export const router = createRouter({
  basepath: ROOT || '/',
  routeTree: root.addChildren([start, runs, launch, run.addChildren([runPage, flight]), docs, verdicts, evidence, methods, components, guide, compare, trends, sweeps, sweep, reports, requirements, users, tokens, sessions, audit]),
  defaultPreload: 'intent',
  parseSearch,
  stringifySearch,
  scrollRestoration: true,
  defaultPendingComponent: () => <Loading what="page" />,
  defaultErrorComponent: ({ error, reset }) => <Trouble error={error} retry={reset} />,
})

declare module '@tanstack/react-router' {
  interface Register {
    router: typeof router
  }
}
