// Edits pin, name and tags of a run; its campaign never changes.
import { IconPencil, IconPin, IconPinnedFilled } from '@tabler/icons-react'
import { useQuery } from '@tanstack/react-query'
import { useState } from 'react'
import { tagOf } from '../../api/calls'
import { useBarredFromOwn } from '../../api/may'
import { facetsQuery } from '../../api/queries'
import type { RunDetail } from '../../client'
import { useEdit } from './useEdit'
import { Field, Form } from '../../ui/Form'
import { TagsInput } from '../../overlay/later'
import { Modal } from '../../overlay/Modal'
import { Button } from '../../ui/Button'
import { IconButton } from '../../ui/IconButton'
import { cards, fields } from '../../ui/styles'

export function EditRun({ run }: { run: RunDetail }) {
  const [open, setOpen] = useState(false)
  const edit = useEdit(run)
  const barred = useBarredFromOwn('engineer', run)
  const pin = run.pinned ? 'Unpin this run' : 'Pin this run to the top of the list'
  return (
    <span className="nw">
      <IconButton bare label="Change name and tags" title={barred} icon={IconPencil} off={barred !== undefined} act={() => setOpen(true)} />
      <IconButton
        bare
        label={pin}
        title={barred}
        icon={run.pinned ? IconPinnedFilled : IconPin}
        pressed={run.pinned}
        off={edit.isPending || barred !== undefined}
        act={() => edit.mutate({ pinned: !run.pinned })}
      />
      {edit.isError && (
        <span className={fields.ferr} role="alert">
          {edit.error.message}
        </span>
      )}
      <Modal opened={open} onClose={() => setOpen(false)} title="Name and tags">
        {open && <EditForm run={run} onDone={() => setOpen(false)} />}
      </Modal>
    </span>
  )
}

function EditForm({ run, onDone }: { run: RunDetail; onDone: () => void }) {
  const [name, setName] = useState(run.name)
  const [tags, setTags] = useState<string[]>(run.tags)
  // Text typed as a tag is added when the form is sent. Adding it on blur would move the button
  // away from under the pointer.
  const [typed, setTyped] = useState('')
  const all = [...new Set([...tags, ...typed.split(/[\s,]+/).filter(Boolean)])]
  const [tag, setTag] = useState(() => tagOf(run.id))
  const newer = tagOf(run.id)
  const edit = useEdit(run, onDone, tag)
  const known = useQuery(facetsQuery).data?.tags.map((tag) => tag.value) ?? []
  const wrong = all.filter((tag) => !/^[\p{L}\p{N}_.+-]{1,40}$/u.test(tag))
  return (
    <Form
      sent={edit}
      onSend={() => edit.mutate({ name: name.trim(), tags: all })}
      send="Save"
      leave="Leave as it is"
      onLeave={onDone}
      off={wrong.length > 0 || !name.trim()}
    >
      <Field label="Name" value={name} maxLength={120} required data-autofocus onChange={setName} />
      <TagsInput
        label="Tags"
        value={tags}
        data={known}
        placeholder={tags.length === 0 ? 'Enter adds a tag' : undefined}
        onChange={setTags}
        searchValue={typed}
        onSearchChange={setTyped}
        acceptValueOnBlur={false}
      />
      {edit.isError && newer !== tag && (
        <div className={cards.note} role="status">
          <b>It is now:</b> {run.name}
          {run.tags.length > 0 && `, ${run.tags.join(', ')}`}
          <Button
            small
            onClick={() => {
              setTag(newer)
              edit.reset()
            }}
          >
            I have read it; keep mine
          </Button>
        </div>
      )}
      {wrong.length > 0 && (
        <p className={fields.ferr}>A tag has at most 40 characters, letters, digits and . _ + -: {wrong.join(', ')}</p>
      )}
    </Form>
  )
}
