// The form of a dialog: its text and fields, why its request was refused, and the buttons at its end.
import type { InputHTMLAttributes, ReactNode } from 'react'
import { clsx } from 'clsx'
import { Button } from './Button'
import { fields, layout } from './styles'

interface FormProps {
  /** The request that the form sends, if it sends one. */
  sent?: { isPending: boolean; error: Error | null }
  onSend: () => void
  /** The words of its button; without them there are only those of `more`. */
  send?: ReactNode
  /** Not complete or not valid. */
  off?: boolean
  danger?: boolean
  /** Closes the dialog. */
  leave?: string
  onLeave?: () => void
  /** Further buttons, between those two. */
  more?: ReactNode
  children: ReactNode
}

export function Form({ sent, onSend, send, off, danger, leave = 'Not now', onLeave, more, children }: FormProps) {
  return (
    <form
      className={fields.panel}
      onSubmit={(event) => {
        event.preventDefault()
        onSend()
      }}
    >
      {children}
      <Refused error={sent?.error} />
      <div className={clsx(layout.acts, layout.end)}>
        {onLeave && <Button onClick={onLeave}>{leave}</Button>}
        {more}
        {send && (
          <Button main type="submit" danger={danger} disabled={sent?.isPending || off}>
            {send}
          </Button>
        )}
      </div>
    </form>
  )
}

/** Why the service refused; nothing without an error. */
export const Refused = ({ error }: { error: Error | null | undefined }) =>
  error && (
    <p className={fields.ferr} role="alert">
      {error.message}
    </p>
  )

interface FieldProps extends Omit<InputHTMLAttributes<HTMLInputElement>, 'value' | 'onChange'> {
  label: string
  value: string
  onChange: (value: string) => void
  /** Of a text of several lines. */
  rows?: number
  'data-autofocus'?: boolean | undefined
  /** Below the field. */
  children?: ReactNode
}

/** A text with its label. */
export function Field({ label, value, onChange, rows, children, ...rest }: FieldProps) {
  const shared = { value, onChange: ({ target }: { target: { value: string } }) => onChange(target.value) }
  return (
    <label className={fields.lbl}>
      {label}
      {rows === undefined ? (
        <input {...rest} {...shared} className={fields.inp} />
      ) : (
        <textarea {...shared} className={clsx(fields.inp, fields.area)} rows={rows} maxLength={rest.maxLength} required={rest.required} data-autofocus={rest['data-autofocus']} />
      )}
      {children}
    </label>
  )
}
