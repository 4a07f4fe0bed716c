// The heading of a page: its title, a line below it, and its actions next to it.
import type { ReactNode } from 'react'
import { layout } from '../ui/styles'

interface PageHeadProps {
  title: string
  note?: ReactNode
  children?: ReactNode
}

export function PageHead({ title, note, children }: PageHeadProps) {
  return (
    <div className={layout.ph}>
      <div className={layout.grow}>
        <h1>{title}</h1>
        {note && <p className="sec">{note}</p>}
      </div>
      {children && <div className={layout.acts}>{children}</div>}
    </div>
  )
}
