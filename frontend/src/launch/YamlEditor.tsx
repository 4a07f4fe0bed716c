// The campaign as text: the lazily loaded editor, and opening and saving files.
import { useMediaQuery } from '@mantine/hooks'
import { IconCircleCheck, IconDownload, IconFileText, IconLoader } from '@tabler/icons-react'
import { clsx } from 'clsx'
import { type DragEvent, useRef, useState } from 'react'
import { later, Part } from '../page/later'
import { Button } from '../ui/Button'
import { Card } from '../ui/Card'
import { CopyButton, save } from '../ui/files'
import type { CodeEditorProps } from './code/CodeEditor'
import { icons, layout } from '../ui/styles'
import styles from './launch.module.css'

const CodeEditor = later(() => import('./code/CodeEditor'), 'default')

interface YamlEditorProps extends Omit<CodeEditorProps, 'readOnly' | 'onChange'> {
  ok: boolean
  onChange: (text: string, how?: 'typed' | 'replaced') => void
}

export function YamlEditor({ ok, ...code }: YamlEditorProps) {
  const { text, checking, problems, onChange } = code
  const [dropping, setDropping] = useState(false)
  const chooser = useRef<HTMLInputElement>(null)
  const take = (file: File | undefined) => void file?.text().then((content) => onChange(content, 'replaced'))
  const drop = (event: DragEvent) => {
    setDropping(false)
    const file = event.dataTransfer.files[0]
    if (!file) return
    // A dropped file replaces the whole text; the editor itself would insert it at the drop position.
    event.preventDefault()
    event.stopPropagation()
    take(file)
  }
  const over = (event: DragEvent) => {
    if (!event.dataTransfer.types.includes('Files')) return
    event.preventDefault()
    setDropping(true)
  }
  // An on-screen keyboard hides the text: on tablets it is read-only and can be replaced by a file.
  const touched = useMediaQuery('(pointer: coarse) and (max-width: 1180px)') ?? false
  const plain = <pre className={clsx('sec', styles.coming)}>{text}</pre>
  return (
    <Card
      title="campaign.yaml"
      note={<State ok={ok} checking={checking} problems={problems.length} />}
      flush
      right={
        <>
          <Button small icon={IconFileText} onClick={() => chooser.current?.click()}>Open file</Button>
          <input
            ref={chooser}
            type="file"
            accept=".yaml,.yml,.json"
            hidden
            onChange={(event) => {
              take(event.target.files?.[0])
              // The same file may be opened again.
              event.target.value = ''
            }}
          />
          <CopyButton text={() => text}>Copy</CopyButton>
          <Button small icon={IconDownload} onClick={() => save('campaign.yaml', text, 'application/yaml')}>Download</Button>
        </>
      }
      footer={
        touched
          ? 'Read only on a tablet: change it in the form, or open a file. The form shows the same campaign.'
          : 'YAML or JSON: paste a campaign, or drop its file here. Tab leaves the editor; Ctrl ] and Ctrl [ indent. Comments stay when the form is edited.'
      }
    >
      <div
        className={dropping ? clsx(styles.editor, styles.drop) : styles.editor}
        onDropCapture={drop}
        onDragOverCapture={over}
        onDragLeave={() => setDropping(false)}
      >
        <Part waiting={plain} failed={(line) => <>{line}{plain}</>}>
          <CodeEditor {...code} readOnly={touched} />
        </Part>
      </div>
    </Card>
  )
}

function State({ ok, checking, problems }: { ok: boolean; checking: boolean; problems: number }) {
  if (!checking && !ok) return <span className="bad-t">{problems === 1 ? 'One problem' : `${problems} problems`}</span>
  return (
    <span className={layout.row} style={{ gap: 5 }}>
      {checking ? <IconLoader className={clsx(icons.spin, 'i s')} aria-hidden /> : <IconCircleCheck className="i s" aria-hidden />}
      {checking ? 'Checking' : 'Valid'}
    </span>
  )
}
