// The routes of the pages; the state of a page is in its address.
import { createRootRoute, createRoute, createRouter, redirect, type RouteComponent } from '@tanstack/react-router'
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
import { laterPage } from '../page/later'
import { Loading, NotFound, Trouble } from '../page/Trouble'
import { text } from '../format/query'
import { ROOT } from '../format/root'

type Search = Record<string, unknown>

const root = createRootRoute({ component: Shell, notFoundComponent: NotFound })

const page = <P extends string>(path: P, component: RouteComponent) =>
  createRoute({ getParentRoute: () => root, path, component })

/** A page whose address states what it shows. */
const statedPage = <P extends string, S extends object>(path: P, component: RouteComponent, read: (search: Search) => S) =>
  createRoute({ getParentRoute: () => root, path, component, validateSearch: onlyKnown(read) })

const start = createRoute({
  getParentRoute: () => root,
  path: '/',
  beforeLoad: () => {
    // oxlint-disable-next-line typescript/only-throw-error -- a redirect of the router
    throw redirect({ to: '/runs' })
  },
})

const runs = statedPage('/runs', laterPage(lazy.runs, 'RunsPage'), readSearch)

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

const readLaunch = (search: Search): LaunchSearch => ({
  case: text(search.case),
  from: text(search.from),
  remedy: text(search.remedy),
  draft: text(search.draft),
  tab: search.tab === 'yaml' ? 'yaml' : undefined,
})

const launch = statedPage('/launch', laterPage(lazy.launch, 'LaunchPage'), readLaunch)

const run = createRoute({
  getParentRoute: () => root,
  path: '/runs/$id',
  validateSearch: onlyKnown(readChosen),
})

const runPage = createRoute({
  getParentRoute: () => run,
  path: '/',
  component: laterPage(lazy.run, 'RunPage'),
})

/** Its 3D view in its own window. */
const flight = createRoute({
  getParentRoute: () => run,
  path: 'flight',
  component: laterPage(lazy.flight, 'FlightPage'),
})

const docs = page('/docs', laterPage(lazy.docs, 'ApiPage'))
const verdicts = page('/help', laterPage(lazy.verdicts, 'VerdictsPage'))
const evidence = page('/help/evidence', laterPage(lazy.evidence, 'EvidencePage'))
const methods = page('/help/methods', laterPage(lazy.methods, 'MethodsPage'))
const components = page('/help/components', laterPage(lazy.components, 'ComponentsPage'))
const guide = page('/help/guides/$name', laterPage(lazy.guide, 'GuidePage'))
const compare = statedPage('/compare', laterPage(lazy.compare, 'ComparePage'), readCompare)
const trends = statedPage('/trends', laterPage(lazy.trends, 'TrendsPage'), readTrend)
const sweeps = page('/sweeps', laterPage(lazy.sweeps, 'SweepsPage'))
const sweep = page('/sweeps/$id', laterPage(lazy.sweep, 'SweepPage'))
const reports = statedPage('/reports', laterPage(lazy.reports, 'ReportsPage'), readReports)
const requirements = statedPage('/requirements', laterPage(lazy.requirements, 'RequirementsPage'), readRequirements)
const users = statedPage('/access/users', laterPage(lazy.users, 'UsersPage'), readUsers)
const tokens = page('/access/tokens', laterPage(lazy.tokens, 'TokensPage'))
const sessions = page('/access/sessions', laterPage(lazy.sessions, 'SessionsPage'))
const audit = statedPage('/access/audit', laterPage(lazy.audit, 'AuditPage'), readAudit)

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
