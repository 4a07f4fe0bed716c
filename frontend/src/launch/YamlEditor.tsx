// The campaign as text: a plain editor with line numbers; a campaign file can be pasted, dropped or opened.
import { useMediaQuery } from '@mantine/hooks'
import { IconCircleCheck, IconDownload, IconFileText, IconLoader } from '@tabler/icons-react'
import { type DragEvent, useRef, useState } from 'react'
import type { FieldProblem } from '../api/problems'
import { Card } from '../ui/Card'
import { CopyButton, save } from '../ui/files'
import { Message } from './problems'

interface YamlEditorProps {
  text: string
  ok: boolean
  checking: boolean
  problems: readonly FieldProblem[]
  onChange: (text: string) => void
}

export function YamlEditor({ text, ok, checking, problems, onChange }: YamlEditorProps) {
  const [dropping, setDropping] = useState(false)
  const chooser = useRef<HTMLInputElement>(null)
  const take = (file: File | undefined) => void file?.text().then(onChange)
  const drop = (event: DragEvent) => {
    event.preventDefault()
    setDropping(false)
    take(event.dataTransfer.files[0])
  }
  const over = (event: DragEvent) => {
    event.preventDefault()
    setDropping(true)
  }
  // A keyboard on the glass hides what is typed: there the text is to be read, copied, and replaced by a file.
  const touched = useMediaQuery('(pointer: coarse) and (max-width: 1180px)') ?? false
  const lines = text.split('\n').length
  return (
    <Card
      title="campaign.yaml"
      note={<State ok={ok} checking={checking} problems={problems.length} />}
      flush
      right={
        <>
          <button type="button" className="btn s" onClick={() => chooser.current?.click()}>
            <IconFileText className="i s" aria-hidden /> Open file
          </button>
          <input
            ref={chooser}
            type="file"
            accept=".yaml,.yml,.json"
            hidden
            onChange={(event) => take(event.target.files?.[0])}
          />
          <CopyButton text={() => text}>Copy</CopyButton>
          <button type="button" className="btn s" onClick={() => save('campaign.yaml', text, 'application/yaml')}>
            <IconDownload className="i s" aria-hidden /> Download
          </button>
        </>
      }
      footer={
        touched
          ? 'Read only on a tablet: change it in the form, or open a file. The form shows the same campaign.'
          : 'YAML or JSON. Paste a campaign, or drop its file here. Tab moves on; the form shows the same campaign.'
      }
    >
      {problems.length > 0 && (
        <div style={{ padding: '0 16px 8px' }}>
          {problems.slice(0, 8).map((problem) => (
            <Message key={problem.field + problem.message} problem={problem} named />
          ))}
        </div>
      )}
      <div className={dropping ? 'editor drop' : 'editor'}>
        <span className="lines" aria-hidden>
          {Array.from({ length: lines }, (_, i) => i + 1).join('\n')}
        </span>
        <textarea
          value={text}
          rows={lines}
          spellCheck={false}
          readOnly={touched}
          aria-label="Campaign as YAML"
          onDrop={drop}
          onDragOver={over}
          onDragLeave={() => setDropping(false)}
          onChange={(event) => onChange(event.target.value)}
        />
      </div>
    </Card>
  )
}

function State({ ok, checking, problems }: { ok: boolean; checking: boolean; problems: number }) {
  if (checking)
    return (
      <span className="row" style={{ gap: 5 }}>
        <IconLoader className="i s spin" aria-hidden /> Checking
      </span>
    )
  if (ok)
    return (
      <span className="row" style={{ gap: 5 }}>
        <IconCircleCheck className="i s" aria-hidden /> Valid
      </span>
    )
  return <span className="bad-t">{problems === 1 ? 'One problem' : `${problems} problems`}</span>
}
