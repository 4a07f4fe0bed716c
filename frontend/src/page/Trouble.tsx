// Placeholders of a page: loading, refused, not found, error.
import { clsx } from 'clsx'
import { IconAlertTriangle, IconLoader } from '@tabler/icons-react'
import type { ReactNode } from 'react'
import { Refusal, statement } from '../api/problems'
import { Button, ButtonLink } from '../ui/Button'
import { cards, icons, layout } from '../ui/styles'
import { PageHead } from './PageHead'
import { useTitle } from './useTitle'
import styles from './page.module.css'

interface LoadingProps {
  what: string
  /** The heading of the page that is loaded. */
  title?: string
  /** Why the last attempt failed, if more follow. */
  failed?: Error | null
}

export function Loading({ what, title, failed }: LoadingProps) {
  return (
    <>
      {title && <PageHead title={title} />}
      <div className={clsx('mut', styles.loading)} role="status">
        <div className={styles.attempts}>
          <span className={layout.row}>
            <IconLoader className={clsx(icons.spin, 'i')} aria-hidden /> Loading {what}
          </span>
          {failed && <p className={layout.wrapAny}>{statement(failed.message)} Trying again.</p>}
        </div>
      </div>
    </>
  )
}

interface TroubleProps {
  error: unknown
  retry?: () => void
  /** Whether to show a link to the runs; not on their own page. */
  onward?: boolean
  /** Below the heading of its page. */
  below?: boolean
}

export function Trouble({ error, retry, onward = true, below = false }: TroubleProps) {
  const refused = error instanceof Refusal ? error : null
  const title = refused ? headingOf(refused.title) : 'This page could not be shown'
  // What does not exist, was purged, or is not permitted is the same the next time.
  const again = refused && [403, 404, 410].includes(refused.status) ? undefined : retry
  const detail = statement(error instanceof Error ? error.message : String(error))
  return (
    <Notice
      title={title}
      below={below}
      actions={
        <>
          {again && (
            <Button main onClick={again}>Try again</Button>
          )}
          {onward && (
            <ButtonLink to="/runs" main={!again}>All runs</ButtonLink>
          )}
        </>
      }
    >
      {detail}
    </Notice>
  )
}

interface NoticeProps {
  title: string
  below?: boolean
  /** Whether it waits for something. */
  busy?: boolean
  actions: ReactNode
  children: ReactNode
}

/** A card in place of a page: why there is none, and what to do. */
export function Notice({ title, below, busy, actions, children }: NoticeProps) {
  const Heading = below ? 'h2' : 'h1'
  const Icon = busy ? IconLoader : IconAlertTriangle
  return (
    <div className={clsx(cards.card, layout.centre)} role="alert">
      <Icon size={36} stroke={1.5} className={busy ? icons.spin : undefined} aria-hidden />
      <Heading>{title}</Heading>
      <p className={layout.wrapAny}>{children}</p>
      <div className={layout.acts}>{actions}</div>
    </div>
  )
}

interface UnloadedProps extends Pick<LoadingProps, 'what' | 'title'>, Pick<TroubleProps, 'onward' | 'below'> {
  query: { error: Error | null; failureReason: Error | null; refetch: () => unknown }
}

/** In place of a page that has not arrived: that it is loaded, or why it cannot be. */
export function Unloaded({ query: { error, failureReason, refetch }, what, title, onward, below }: UnloadedProps) {
  if (error) return <Trouble error={error} retry={() => void refetch()} onward={onward} below={below} />
  return <Loading what={what} title={title} failed={failureReason} />
}

interface LoadedProps<T> {
  query: UnloadedProps['query'] & { data: T | undefined }
  what: string
  children: (data: T) => ReactNode
}

/** The content of a page below its heading, once it has arrived; what was read once stays. */
export const Loaded = <T,>({ query, what, children }: LoadedProps<T>) =>
  query.data === undefined ? <Unloaded query={query} what={what} below /> : children(query.data)

/** A part of a page that could not be loaded, within its card. */
export function Failed({ error, retry, label = 'Try again' }: { error: Error; retry: () => void; label?: string }) {
  return (
    <p className={layout.row} role="alert">
      <span className={clsx('bad-t', layout.wrapAny)}>{statement(error.message)}</span>
      <Button small onClick={retry}>{label}</Button>
    </p>
  )
}

const HEADINGS: Record<string, string> = {
  Forbidden: 'Not permitted',
  'Internal Server Error': 'The service failed on this request',
  'Service Unavailable': 'Not available at the moment',
  'Unprocessable Entity': 'This request was refused',
  'Unprocessable Content': 'This request was refused',
}

/** The words of the protocol as a heading of ours; "Not Found" becomes "Not found". */
const headingOf = (title: string): string => HEADINGS[title] ?? title.charAt(0).toUpperCase() + title.slice(1).toLowerCase()

export function NotFound() {
  useTitle('Page not found')
  return <Trouble error={new Refusal(404, 'Page not found', 'The address may be mistyped.')} />
}
