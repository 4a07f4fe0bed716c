// What is shown only once: a link or a token, to be copied.
import type { ReactNode } from 'react'
import { CopyButton } from '../ui/files'
import styles from './access.module.css'

export function Secret({ text, copy, children, onDone }: { text: string; copy: string; children: ReactNode; onDone: () => void }) {
  return (
    <div className="panel">
      <p className="sec">{children}</p>
      <code className={`mono ${styles.secret ?? ''}`} data-testid="secret">
        {text}
      </code>
      <div className="acts" style={{ justifyContent: 'flex-end' }}>
        <CopyButton text={() => text}>{copy}</CopyButton>
        <button type="button" className="btn p" onClick={onDone}>
          Done
        </button>
      </div>
    </div>
  )
}
