// What a dialog asks: its text and fields, what was refused, and the buttons at its end.
import { clsx } from 'clsx'
import type { ReactNode } from 'react'
import buttons from './buttons.module.css'
import fields from './fields.module.css'
import layout from './layout.module.css'

export interface DialogFormProps {
  error: Error | null
  /** The words of the button that does it; without them there are only those of `more`. */
  submit?: ReactNode
  disabled?: boolean
  danger?: boolean
  onSubmit: () => void
  /** Closes the dialog. */
  leave?: string
  onLeave?: () => void
  /** Further buttons, between those two. */
  more?: ReactNode
  children: ReactNode
}

export function DialogForm({ error, submit, disabled, danger, onSubmit, leave = 'Not now', onLeave, more, children }: DialogFormProps) {
  return (
    <form
      className={fields.panel}
      onSubmit={(event) => {
        event.preventDefault()
        onSubmit()
      }}
    >
      {children}
      <Refused error={error} />
      <div className={clsx(layout.acts, layout.end)}>
        {onLeave && (
          <button type="button" className={buttons.btn} onClick={onLeave}>
            {leave}
          </button>
        )}
        {more}
        {submit && (
          <button type="submit" className={clsx(buttons.btn, danger && buttons.danger, buttons.p)} disabled={disabled}>
            {submit}
          </button>
        )}
      </div>
    </form>
  )
}

/** Why the service refused; nothing without an error. */
export const Refused = ({ error }: { error: Error | null }) =>
  error && (
    <p className={fields.ferr} role="alert">
      {error.message}
    </p>
  )
