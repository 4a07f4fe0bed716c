// The heading of the pages about access, with links among them.
import { clsx } from 'clsx'
import { useQuery } from '@tanstack/react-query'
import { Link } from '@tanstack/react-router'
import type { ReactNode } from 'react'
import { sessionQuery } from '../api/queries'
import { PageHead } from '../page/PageHead'
import { useTitle } from '../page/useTitle'
import { layout } from '../ui/styles'
import { pagesFor } from './pages'
import styles from './access.module.css'

export function AccessFrame({ title, actions, children }: { title: string; actions?: ReactNode; children: ReactNode }) {
  useTitle(title)
  const { data } = useQuery(sessionQuery)
  return (
    <div className={styles.page}>
      <PageHead title={title}>{actions}</PageHead>
      <nav className={clsx(layout.tabs, styles.tabs)} aria-label="Access">
        {pagesFor(data?.role).map(({ to, name }) => (
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
