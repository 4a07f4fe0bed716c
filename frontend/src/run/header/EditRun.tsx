// Edits pin, name and tags of a run; its campaign never changes.
import { clsx } from 'clsx'
import { TagsInput } from '@mantine/core'
import { IconPencil, IconPin, IconPinnedFilled } from '@tabler/icons-react'
import { useQuery } from '@tanstack/react-query'
import { useState } from 'react'
import { useBarredFromOwn } from '../../api/may'
import { facetsQuery } from '../../api/queries'
import type { RunDetail } from '../../client'
import { useEdit } from './useEdit'
import { Modal } from '../../ui/Modal'
import buttons from '../../ui/buttons.module.css'
import fields from '../../ui/fields.module.css'
import layout from '../../ui/layout.module.css'

export function EditRun({ run }: { run: RunDetail }) {
  const [open, setOpen] = useState(false)
  const edit = useEdit(run)
  const barred = useBarredFromOwn('engineer', run)
  const pin = run.pinned ? 'Unpin this run' : 'Pin this run to the top of the list'
  return (
    <span className="nw">
      <button
        type="button"
        className={buttons.iconbtn}
        onClick={() => setOpen(true)}
        disabled={barred !== undefined}
        aria-label="Change name and tags"
        title={barred ?? 'Change name and tags'}
      >
        <IconPencil className="i s" aria-hidden />
      </button>
      <button
        type="button"
        className={buttons.iconbtn}
        onClick={() => edit.mutate({ pinned: !run.pinned })}
        disabled={edit.isPending || barred !== undefined}
        aria-pressed={run.pinned}
        aria-label={pin}
        title={barred ?? pin}
      >
        {run.pinned ? <IconPinnedFilled className="i s" aria-hidden /> : <IconPin className="i s" aria-hidden />}
      </button>
      <Modal opened={open} onClose={() => setOpen(false)} title="Name and tags" centered lockScroll={false}>
        {open && <Form run={run} onDone={() => setOpen(false)} />}
      </Modal>
    </span>
  )
}

function Form({ run, onDone }: { run: RunDetail; onDone: () => void }) {
  const [name, setName] = useState(run.name)
  const [tags, setTags] = useState<string[]>(run.tags)
  // Text typed as a tag is added when the form is sent. Adding it on blur would move the button
  // away from under the pointer.
  const [typed, setTyped] = useState('')
  const all = [...new Set([...tags, ...typed.split(/[\s,]+/).filter(Boolean)])]
  const edit = useEdit(run, onDone)
  const known = useQuery(facetsQuery).data?.tags.map((tag) => tag.value) ?? []
  const wrong = all.filter((tag) => !/^[\p{L}\p{N}_.+-]{1,40}$/u.test(tag))
  return (
    <form
      className={fields.panel}
      onSubmit={(event) => {
        event.preventDefault()
        edit.mutate({ name: name.trim(), tags: all })
      }}
    >
      <label className={fields.lbl}>
        Name
        <input
          className={fields.inp}
          value={name}
          maxLength={120}
          required
          data-autofocus
          onChange={(event) => setName(event.target.value)}
        />
      </label>
      <TagsInput
        label="Tags"
        labelProps={{ className: fields.lbl }}
        size="xs"
        value={tags}
        data={known}
        maxTags={20}
        splitChars={[',', ' ']}
        placeholder={tags.length === 0 ? 'Enter adds a tag' : undefined}
        onChange={setTags}
        searchValue={typed}
        onSearchChange={setTyped}
        acceptValueOnBlur={false}
      />
      {wrong.length > 0 && (
        <p className={fields.ferr}>A tag consists of letters, digits and . _ + -, at most 40 of them: {wrong.join(', ')}</p>
      )}
      {edit.isError && <p className={fields.ferr}>{edit.error.message}</p>}
      <div className={layout.acts} style={{ justifyContent: 'flex-end' }}>
        <button type="button" className={buttons.btn} onClick={onDone}>
          Leave as it is
        </button>
        <button type="submit" className={clsx(buttons.btn, buttons.p)} disabled={edit.isPending || wrong.length > 0 || !name.trim()}>
          Save
        </button>
      </div>
    </form>
  )
}
