// Placeholders of a page: loading, refused, not found, error.
import { IconAlertTriangle, IconLoader } from '@tabler/icons-react'
import { Link } from '@tanstack/react-router'
import { Refusal } from '../api/problems'
import styles from './page.module.css'

export function Loading({ what }: { what: string }) {
  return (
    <div className={styles.loading} role="status">
      <span className="row">
        <IconLoader className="i spin" aria-hidden /> Loading {what}
      </span>
    </div>
  )
}

interface TroubleProps {
  error: unknown
  retry?: () => void
  /** Whether to show a link to the runs; not on their own page. */
  onward?: boolean
}

export function Trouble({ error, retry, onward = true }: TroubleProps) {
  const title = error instanceof Refusal ? error.title : 'This page could not be shown'
  const detail = error instanceof Error ? error.message : String(error)
  return (
    <div className="card centre" role="alert">
      <IconAlertTriangle size={36} stroke={1.5} aria-hidden />
      <h1>{title}</h1>
      <p className="wrap-any">{detail.charAt(0).toUpperCase() + detail.slice(1)}</p>
      <div className="acts">
        {retry && (
          <button type="button" className="btn p" onClick={retry}>
            Try again
          </button>
        )}
        {onward && (
          <Link to="/runs" className="btn">
            All runs
          </Link>
        )}
      </div>
    </div>
  )
}

export function NotFound() {
  return <Trouble error={new Refusal(404, 'Page not found', 'The address may be mistyped.')} />
}
