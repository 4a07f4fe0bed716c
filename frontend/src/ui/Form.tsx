// The form of a dialog that sends one request, and its fields.
import type { InputHTMLAttributes, ReactNode } from 'react'
import { clsx } from 'clsx'
import { type DialogFormProps, DialogForm } from './DialogForm'
import fields from './fields.module.css'

interface FormProps extends Pick<DialogFormProps, 'leave' | 'danger' | 'more' | 'children'> {
  onLeave: () => void
  /** The request that the form sends. */
  sent: { isPending: boolean; error: Error | null }
  onSend: () => void
  /** The words of its button. */
  send: ReactNode
  /** Not complete or not valid. */
  off?: boolean
}

export function Form({ sent, onSend, send, off = false, children, ...rest }: FormProps) {
  return (
    <DialogForm error={sent.error} submit={send} disabled={sent.isPending || off} onSubmit={onSend} {...rest}>
      {children}
    </DialogForm>
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
