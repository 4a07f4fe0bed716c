// The form of a dialog: its fields, why it was refused, and its buttons.
import type { InputHTMLAttributes, ReactNode } from 'react'
import { clsx } from 'clsx'
import { Button } from './Button'
import fields from './fields.module.css'
import layout from './layout.module.css'

interface FormProps {
  /** The request that the form sends. */
  sent: { isPending: boolean; error: Error | null }
  onSend: () => void
  /** The words of its buttons. */
  send: ReactNode
  leave?: string
  onLeave: () => void
  danger?: boolean
  /** Not complete or not valid. */
  off?: boolean
  /** Further buttons, between the two. */
  more?: ReactNode
  children: ReactNode
}

export function Form({ sent, onSend, send, leave = 'Not now', onLeave, danger, off = false, more, children }: FormProps) {
  return (
    <form
      className={fields.panel}
      onSubmit={(event) => {
        event.preventDefault()
        onSend()
      }}
    >
      {children}
      {sent.error && (
        <p className={fields.ferr} role="alert">
          {sent.error.message}
        </p>
      )}
      <div className={layout.acts} style={{ justifyContent: 'flex-end' }}>
        <Button onClick={onLeave}>{leave}</Button>
        {more}
        <Button type="submit" main danger={danger} disabled={sent.isPending || off}>
          {send}
        </Button>
      </div>
    </form>
  )
}

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
