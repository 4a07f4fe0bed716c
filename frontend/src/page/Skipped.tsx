// What was skipped because it cannot be used: file, line and the sentence that says what to do.
import { clsx } from 'clsx'
import { IconAlertTriangle } from '@tabler/icons-react'
import type { UnusableEntry } from '../client'
import { cards, layout } from '../ui/styles'
import styles from './page.module.css'

export function Skipped({ unusable }: { unusable: readonly UnusableEntry[] | undefined }) {
  if (!unusable?.length) return null
  return (
    <section className={clsx(cards.note, cards.warn)} aria-label="What cannot be used" data-testid="skipped">
      <IconAlertTriangle className="i" aria-hidden />
      <div className={styles.skipped}>
        <p className="m">{heading(unusable)}</p>
        <ul>
          {unusable.map(({ file, line, text, name }) => (
            <li key={`${file} ${line} ${name} ${text}`} className={layout.wrapAny}>
              {file && (
                <>
                  <span className="mono">{file}</span>
                  {line ? `, line ${line}` : ''}:{' '}
                </>
              )}
              {text}
            </li>
          ))}
        </ul>
      </div>
    </section>
  )
}

function heading(unusable: readonly UnusableEntry[]): string {
  const kinds = [...new Set(unusable.map((entry) => entry.kind ?? 'component'))]
  if (unusable.length === 1) return `A ${kinds[0]} cannot be used.`
  const named = new Intl.ListFormat('en-GB', { type: 'disjunction' }).format(kinds.map((kind) => `${kind}s`))
  return `${unusable.length} ${named} cannot be used.`
}
