// Renders the text of a component or method: equations on their own lines, sources labelled.
import { clsx } from 'clsx'
import type { ReactNode } from 'react'
import { partsOf } from './docstring'
import { Ticked } from '../ui/Ticked'
import { lists, prose } from '../ui/styles'
import styles from './help.module.css'

export function Docstring({ text }: { text: string }) {
  const { title, parts } = partsOf(text)
  return (
    <div className={prose.md}>
      <p className="m">{title}</p>
      {parts.map((part, i) =>
        part.kind === 'text' ? (
          <p key={i} className={part.label ? 'sec' : undefined}>
            {part.label && <span className="b">{part.label}: </span>}
            <Ticked text={part.text} />
          </p>
        ) : (
          <pre key={i} className={part.kind === 'equations' ? clsx('mono', styles.eq) : 'mono'} tabIndex={0}>
            {part.text}
          </pre>
        ),
      )}
    </div>
  )
}

interface AboutProps {
  summary: string
  text: string
  /** Below the text. */
  children?: ReactNode
}

/** The same, folded, below the fields of what it describes. */
export const About = ({ summary, text, children }: AboutProps) => (
  <details>
    <summary>{summary}</summary>
    <div className={clsx('sec small', lists.about)}>
      <Docstring text={text} />
      {children}
    </div>
  </details>
)
