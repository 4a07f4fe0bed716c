// Adding a requirement, changing its text, deleting it.
import { useState } from 'react'
import { useChange } from '../api/change'
import { deleteRequirement, type RequirementRow, writeRequirement } from '../client'
import { Button } from '../ui/Button'
import { Field, Form } from '../ui/Form'

interface WriteFormProps {
  /** Null: a new one. */
  row: RequirementRow | null
  onDone: () => void
}

export function WriteForm({ row, onDone }: WriteFormProps) {
  const [id, setId] = useState(row?.id ?? '')
  const [text, setText] = useState(row?.text ?? '')
  // As it was read: what another user changes meanwhile is not overwritten, even after the list was read again.
  const [headers] = useState(row?.etag === undefined ? {} : { 'If-Match': row.etag })
  const write = useChange(() => writeRequirement({ body: { id: id.trim(), text: text.trim() }, headers }), ['requirements'], onDone)
  const remove = useChange(() => deleteRequirement({ query: { requirement: id }, headers }), ['requirements'], onDone)
  const [leaving, setLeaving] = useState(false)
  return (
    <Form
      sent={{ isPending: write.isPending, error: write.error ?? remove.error }}
      onSend={() => write.mutate()}
      send={row ? 'Save' : 'Add'}
      onLeave={onDone}
      off={!id.trim() || !text.trim()}
      more={
        row?.registered && (
          <Button danger disabled={remove.isPending} onClick={() => (leaving ? remove.mutate() : setLeaving(true))}>
            {leaving ? 'Delete the requirement' : 'Delete …'}
          </Button>
        )
      }
    >
      <Field label="Id" value={id} maxLength={120} required disabled={row !== null} data-autofocus={row === null || undefined} onChange={setId} />
      <Field label="Text" value={text} maxLength={20_000} required rows={6} onChange={setText}>
        {row?.registered && <span className="small mut">Changing the text makes its evidence suspect.</span>}
      </Field>
      {leaving && (
        <p className="small" role="status">
          {id} and its text are deleted. Where a run states it, it stays in the matrix, as stated by campaigns only.
        </p>
      )}
    </Form>
  )
}
