// The lines of a menu's entry: its title, and what it does or why it cannot.
import type { ReactNode } from 'react'

export const EntryLines = ({ title, live, children }: { title: string; live?: boolean; children: ReactNode }) => (
  <>
    <span className="b">{title}</span>
    <span className="small mut" style={{ display: 'block', whiteSpace: 'normal' }} aria-live={live ? 'polite' : undefined}>
      {children}
    </span>
  </>
)
