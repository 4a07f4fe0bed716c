// What is shown only once: a link or a token, to be copied.
import { clsx } from 'clsx'
import type { ReactNode } from 'react'
import { CopyButton } from '../ui/files'
import styles from './access.module.css'
import buttons from '../ui/buttons.module.css'
import fields from '../ui/fields.module.css'
import layout from '../ui/layout.module.css'

export function Secret({ text, copy, children, onDone }: { text: string; copy: string; children: ReactNode; onDone: () => void }) {
  return (
    <div className={fields.panel}>
      <p className="sec">{children}</p>
      <code className={`mono ${styles.secret ?? ''}`} data-testid="secret">
        {text}
      </code>
      <div className={layout.acts} style={{ justifyContent: 'flex-end' }}>
        <CopyButton text={() => text}>{copy}</CopyButton>
        <button type="button" className={clsx(buttons.btn, buttons.p)} onClick={onDone}>
          Done
        </button>
      </div>
    </div>
  )
}
