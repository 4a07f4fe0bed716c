// A collapsible section with a summary, open if it contains a problem.
import { type ReactNode, useState } from 'react'
import { useTroubled } from './problems'
import styles from './fields.module.css'

interface FoldProps {
  title: string
  /** A short summary. */
  digest?: ReactNode
  /** The fields inside, by their service names. */
  fields: readonly string[]
  children: ReactNode
}

export function Fold({ title, digest, fields, children }: FoldProps) {
  const [open, setOpen] = useState(false)
  const troubled = useTroubled(fields)
  return (
    <details className={styles.fold} open={open || troubled > 0} onToggle={(event) => setOpen(event.currentTarget.open)}>
      <summary>
        <span className="b">{title}</span>
        <span className="mut">{digest}</span>
        {troubled > 0 && <span className="bad-t">{troubled === 1 ? 'One problem' : `${troubled} problems`}</span>}
      </summary>
      <div className={styles.in}>{children}</div>
    </details>
  )
}
