// What is shown only once: a link or a token, to be copied.
import type { ReactNode } from 'react'
import { Form } from '../ui/Form'
import { CopyButton } from '../ui/files'
import styles from './access.module.css'

export function Secret({ text, copy, children, onDone }: { text: string; copy: string; children: ReactNode; onDone: () => void }) {
  return (
    <Form send="Done" onSend={onDone} more={<CopyButton text={() => text}>{copy}</CopyButton>}>
      <p className="sec">{children}</p>
      <code className={`mono ${styles.secret ?? ''}`} data-testid="secret">
        {text}
      </code>
    </Form>
  )
}
