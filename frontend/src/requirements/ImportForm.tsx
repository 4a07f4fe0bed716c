// Importing a file of requirements: the file, the attributes with id and text, and what has changed.
import { clsx } from 'clsx'
import { useState } from 'react'
import { useChange } from '../api/change'
import { kindOf } from '../api/requirements'
import { type Imported, importRequirements } from '../client'
import { count } from '../format/numbers'
import { Button } from '../ui/Button'
import { Field, Form } from '../ui/Form'
import { buttons, fields, layout } from '../ui/styles'
import styles from './requirements.module.css'

export function ImportForm({ onDone }: { onDone: () => void }) {
  const [file, setFile] = useState<File | null>(null)
  const [idAttribute, setId] = useState('')
  const [textAttribute, setText] = useState('')
  const send = useChange(
    (body: File) => importRequirements({ body, query: { name: body.name, kind: kindOf(body.name), id_attribute: idAttribute, text_attribute: textAttribute } }),
    ['requirements', 'requirement-files'],
  )
  if (send.data) return <Done imported={send.data} onDone={onDone} />
  return (
    <Form
      sent={send}
      onSend={() => file && send.mutate(file)}
      send={send.isPending ? 'Importing …' : 'Import'}
      onLeave={onDone}
      off={!file}
    >
      <label className={fields.lbl}>
        File
        <input
          type="file"
          className={clsx('sec', buttons.choosing, styles.file)}
          accept=".csv,.reqif,.xml"
          required
          onChange={({ target }) => {
            setFile(target.files?.[0] ?? null)
            send.reset()
          }}
        />
        <span className="small mut">
          ReqIF, or CSV with the columns id and text; at most 8 MB. A file of the same name replaces the earlier one.
        </span>
      </label>
      <details>
        <summary className="small">Other names of attributes or columns</summary>
        <Field label="Id" value={idAttribute} maxLength={120} placeholder="ReqIF.ForeignID" onChange={setId} />
        <Field label="Text" value={textAttribute} maxLength={120} placeholder="ReqIF.Text" onChange={setText} />
      </details>
    </Form>
  )
}

function Done({ imported: { file, added, changed, unchanged, gone, skipped }, onDone }: { imported: Imported; onDone: () => void }) {
  const lines = [
    `${count(added.length)} added, ${count(changed.length)} changed, ${count(unchanged)} unchanged.`,
    gone.length > 0 && `No longer in the file: ${gone.slice(0, 20).join(', ')}${gone.length > 20 ? ' …' : ''}.`,
    changed.length > 0 && `Another text: ${changed.slice(0, 20).join(', ')}${changed.length > 20 ? ' …' : ''}. Evidence for the earlier text is suspect.`,
    skipped > 0 && `${count(skipped)} without a text, such as headings, were skipped.`,
  ].filter(Boolean)
  return (
    <div className={fields.panel} role="status">
      <p className="b">{file.name} is imported.</p>
      {lines.map((line) => (
        <p key={String(line)}>{line}</p>
      ))}
      <div className={layout.acts} style={{ justifyContent: 'flex-end' }}>
        <Button main onClick={onDone}>Done</Button>
      </div>
    </div>
  )
}
