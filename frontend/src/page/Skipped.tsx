// Components that cannot be used: file, line and the sentence that says what to do.
import { IconAlertTriangle } from '@tabler/icons-react'
import type { UnusableEntry } from '../client'
import styles from './page.module.css'

export function Skipped({ unusable }: { unusable: readonly UnusableEntry[] | undefined }) {
  if (!unusable?.length) return null
  return (
    <section className="note warn" aria-label="Components that cannot be used" data-testid="skipped">
      <IconAlertTriangle className="i" aria-hidden />
      <div className={styles.skipped}>
        <p className="m">{unusable.length === 1 ? 'A component cannot be used.' : `${unusable.length} components cannot be used.`}</p>
        <ul>
          {unusable.map(({ file, line, text, name }) => (
            <li key={`${file} ${line} ${name} ${text}`} className="wrap-any">
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
