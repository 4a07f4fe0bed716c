// The heading of the pages about access, with links among them.
import { clsx } from 'clsx'
import { useQuery } from '@tanstack/react-query'
import { Link } from '@tanstack/react-router'
import type { ReactNode } from 'react'
import { hasRole, type Role } from '../api/access'
import { sessionQuery } from '../api/queries'
import { PageHead } from '../page/PageHead'
import { useTitle } from '../page/useTitle'
import { layout } from '../ui/styles'
import styles from './access.module.css'

const PAGES = [
  { to: '/access/users', name: 'Users', least: 'admin' },
  { to: '/access/tokens', name: 'API tokens', least: 'viewer' },
  { to: '/access/sessions', name: 'Sessions', least: 'viewer' },
  { to: '/access/audit', name: 'Audit trail', least: 'reviewer' },
] as const satisfies readonly { to: string; name: string; least: Role }[]

export function AccessFrame({ title, actions, children }: { title: string; actions?: ReactNode; children: ReactNode }) {
  useTitle(title)
  const { data } = useQuery(sessionQuery)
  return (
    <div className={styles.page}>
      <PageHead title={title}>{actions}</PageHead>
      <nav className={clsx(layout.tabs, styles.tabs)} aria-label="Access">
        {PAGES.filter(({ least }) => hasRole(data?.role, least)).map(({ to, name }) => (
          <Link key={to} to={to} activeProps={{ 'aria-current': 'page' }}>
            {name}
          </Link>
        ))}
        <Link to="/help/guides/$name" params={{ name: 'access' }}>
          Guide
        </Link>
      </nav>
      {children}
    </div>
  )
}
