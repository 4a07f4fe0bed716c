// The heading of a page: its title, a line below it, and its actions beside it.
import { clsx } from 'clsx'
import type { ReactNode } from 'react'
import { layout } from '../ui/styles'

interface PageHeadProps {
  title: string
  note?: ReactNode
  /** Classes of the heading, and of its actions. */
  className?: string
  acts?: string
  children?: ReactNode
}

export function PageHead({ title, note, className, acts, children }: PageHeadProps) {
  return (
    <div className={clsx(layout.ph, className)}>
      <div className={layout.t}>
        <h1>{title}</h1>
        {note && <p className="sec">{note}</p>}
      </div>
      {children && <div className={clsx(layout.acts, acts)}>{children}</div>}
    </div>
  )
}
