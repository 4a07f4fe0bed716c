// A search box for runs: what is typed is reported after a short pause.
import { clsx } from 'clsx'
import { IconSearch } from '@tabler/icons-react'
import { useEffect, useEffectEvent, useRef, useState } from 'react'
import { useHotkeys } from './useHotkeys'
import { buttons, fields } from './styles'

interface SearchBoxProps {
  label: string
  value: string
  /** What may be searched for. */
  hint?: string
  /** Has the focus at first. */
  begin?: boolean
  onChange: (value: string) => void
}

export function SearchBox({ label, value, hint = 'Name, number, tag, user', begin = false, onChange }: SearchBoxProps) {
  const input = useRef<HTMLInputElement>(null)
  const [text, setText] = useState(value)
  const sent = useRef(value)
  const report = useEffectEvent(onChange)
  useHotkeys({ '/': () => input.current?.focus() })
  useEffect(() => {
    if (begin) input.current?.focus()
  }, [begin])

  // External changes (back button, cleared filters) update the box; text being typed is kept.
  useEffect(() => {
    if (value !== sent.current) {
      sent.current = value
      setText(value)
    }
  }, [value])

  useEffect(() => {
    if (text === sent.current) return
    const timer = setTimeout(() => {
      sent.current = text
      report(text.trim())
    }, 250)
    return () => clearTimeout(timer)
  }, [text])

  return (
    <label className={clsx(fields.inp, fields.search)}>
      <IconSearch className="i s mut" aria-hidden />
      <input
        ref={input}
        type="search"
        value={text}
        placeholder={hint}
        aria-label={label}
        onChange={(event) => setText(event.target.value)}
        onKeyDown={(event) => {
          if (event.key !== 'Escape') return
          event.preventDefault() // what was searched for stays; the browser would clear it
          event.currentTarget.blur()
        }}
      />
      <span className={buttons.kbd}>/</span>
    </label>
  )
}
