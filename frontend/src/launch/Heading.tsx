// The origin of the edited campaign: new, an earlier run, or a draft.
import { clsx } from 'clsx'
import { IconCopy, IconFileText } from '@tabler/icons-react'
import { Link } from '@tanstack/react-router'
import type { ReactNode } from 'react'
import type { Draft, Span } from '../client'
import { moment, when } from '../format/time'
import { RunLink } from '../ui/RunLink'
import { Spans } from '../ui/Spans'
import { useNow } from '../ui/useNow'
import { cards, layout } from '../ui/styles'
import styles from './launch.module.css'

interface HeadingProps {
  from: string | undefined
  /** What the page of that run proposed to change. */
  changed: Span[] | undefined
  /** The baseline of that run, which the new one has too. */
  baseline: string | undefined
  draft: Draft | null
}

export function Heading({ from, changed = [], baseline, draft }: HeadingProps) {
  const now = useNow(30_000, draft !== null)
  return (
    <div className={clsx(layout.ph, styles.begins)}>
      <div className={layout.grow}>
        <h1>{draft ? `Draft ${draft.id}` : 'New run'}</h1>
      </div>
      {draft && (
        <Note icon={<IconFileText className="i" aria-hidden />}>
          Saved by {draft.saved_by} <span title={moment(draft.saved)}>{when(draft.saved, now)}</span>
          {draft.run && (
            <>
              , started as <RunLink run={draft.run} />
            </>
          )}
          . <Link to="/launch">Begin another campaign</Link>
        </Note>
      )}
      {from && !draft && (
        <Note icon={<IconCopy className="i" aria-hidden />}>
          Starts from <RunLink run={from} />
          {changed.length > 0 && (
            <>
              , <Spans spans={changed} />
            </>
          )}
          {baseline && (
            <>
              , with its baseline <span className="mono">{baseline}</span>
            </>
          )}
          . <Link to="/launch">Choose from the library instead</Link>
        </Note>
      )}
    </div>
  )
}

function Note({ icon, children }: { icon: ReactNode; children: ReactNode }) {
  return (
    <span className={cards.note}>
      {icon}
      <span className={layout.wrapAny}>{children}</span>
    </span>
  )
}
