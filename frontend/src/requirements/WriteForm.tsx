// Adding a requirement, changing its text, deleting it.
import { useMutation, useQueryClient } from '@tanstack/react-query'
import { clsx } from 'clsx'
import { useState } from 'react'
import { deleteRequirement, writeRequirement } from '../api/requirements'
import type { RequirementRow } from '../client'
import buttons from '../ui/buttons.module.css'
import fields from '../ui/fields.module.css'
import layout from '../ui/layout.module.css'
import styles from './requirements.module.css'

interface WriteFormProps {
  /** Null: a new one. */
  row: RequirementRow | null
  onDone: () => void
}

export function WriteForm({ row, onDone }: WriteFormProps) {
  const cache = useQueryClient()
  const [id, setId] = useState(row?.id ?? '')
  const [text, setText] = useState(row?.text ?? '')
  // As it was read: what somebody else changes meanwhile is not overwritten, even after the list was read again.
  const [etag] = useState(row?.etag)
  const onSuccess = () => cache.invalidateQueries({ queryKey: ['requirements'] }).then(onDone)
  const write = useMutation({ mutationFn: () => writeRequirement(id.trim(), text.trim(), etag), onSuccess })
  const remove = useMutation({ mutationFn: () => deleteRequirement(id, etag), onSuccess })
  const [leaving, setLeaving] = useState(false)
  const error = write.error ?? remove.error
  return (
    <form
      className={fields.panel}
      onSubmit={(event) => {
        event.preventDefault()
        write.mutate()
      }}
    >
      <label className={fields.lbl}>
        Id
        <input className={fields.inp} value={id} maxLength={120} required disabled={row !== null} data-autofocus={row === null || undefined} onChange={({ target }) => setId(target.value)} />
      </label>
      <label className={fields.lbl}>
        Text
        <textarea className={clsx(fields.inp, styles.area)} value={text} maxLength={20_000} required rows={6} onChange={({ target }) => setText(target.value)} />
        {row?.registered && <span className="small mut">Another text makes evidence for the earlier one suspect.</span>}
      </label>
      {leaving && (
        <p className="small" role="status">
          {id} and its text are deleted. Where a run states it, it stays in the matrix, as stated by campaigns only.
        </p>
      )}
      {error && (
        <p className={fields.ferr} role="alert">
          {error.message}
        </p>
      )}
      <div className={layout.acts} style={{ justifyContent: 'flex-end' }}>
        <button type="button" className={buttons.btn} onClick={onDone}>
          Not now
        </button>
        {row?.registered && (
          <button type="button" className={clsx(buttons.btn, buttons.danger)} disabled={remove.isPending} onClick={() => (leaving ? remove.mutate() : setLeaving(true))}>
            {leaving ? 'Delete the requirement' : 'Delete …'}
          </button>
        )}
        <button type="submit" className={clsx(buttons.btn, buttons.p)} disabled={write.isPending || !id.trim() || !text.trim()}>
          {row ? 'Save' : 'Add'}
        </button>
      </div>
    </form>
  )
}
