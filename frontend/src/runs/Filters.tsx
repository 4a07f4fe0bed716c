// Outcome chips with their counts, and the search box; all of it in the address.
import { IconSearch, IconX } from '@tabler/icons-react'
import { useEffect, useRef, useState } from 'react'
import { count } from '../format/numbers'
import { useHotkeys } from '../ui/useHotkeys'
import { lookOf, OutcomeIcon } from '../ui/VerdictBadge'
import { type RunsSearch, SHOWS, type Show } from './search'

const TONE: Record<string, string> = {
  ok: 'var(--ok-solid)',
  bad: 'var(--bad-solid)',
  unk: 'var(--unk-solid)',
  run: 'var(--run)',
}

interface FiltersProps {
  search: RunsSearch
  counts: Record<string, number>
  onChange: (change: Partial<RunsSearch>) => void
}

export function Filters({ search, counts, onChange }: FiltersProps) {
  const numberOf = (show: Show) => (counts[show] ?? 0) + (show === 'running' ? (counts.cancelling ?? 0) : 0)
  const shown = SHOWS.filter((show) => numberOf(show) > 0 || search.show === show)
  return (
    <div className="filters">
      <button type="button" className="chip" aria-pressed={!search.show} onClick={() => onChange({ show: undefined })}>
        All <span className="n">{count(counts.total)}</span>
      </button>
      {shown.map((show) => (
        <button
          key={show}
          type="button"
          className="chip"
          aria-pressed={search.show === show}
          onClick={() => onChange({ show: search.show === show ? undefined : show })}
        >
          <span style={{ color: TONE[lookOf(show).tone], display: 'flex' }}>
            <OutcomeIcon outcome={show} />
          </span>
          {lookOf(show).word} <span className="n">{count(numberOf(show))}</span>
        </button>
      ))}
      {search.tag && (
        <button type="button" className="chip" aria-pressed onClick={() => onChange({ tag: undefined })}>
          Tag {search.tag} <IconX className="i" aria-label="Remove" />
        </button>
      )}
      <SearchBox value={search.q ?? ''} onChange={(q) => onChange({ q: q || undefined })} />
    </div>
  )
}

function SearchBox({ value, onChange }: { value: string; onChange: (value: string) => void }) {
  const input = useRef<HTMLInputElement>(null)
  const [text, setText] = useState(value)
  const sent = useRef(value)
  useHotkeys({ '/': () => input.current?.focus() })

  // Changes from outside (back button, cleared filters) reach the box; what is being typed stays.
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
      onChange(text.trim())
    }, 250)
    return () => clearTimeout(timer)
  }, [text, onChange])

  return (
    <label className="inp search">
      <IconSearch className="i s mut" aria-hidden />
      <input
        ref={input}
        type="search"
        value={text}
        placeholder="Name, number, tag or campaign"
        aria-label="Search runs"
        onChange={(event) => setText(event.target.value)}
        onKeyDown={(event) => event.key === 'Escape' && event.currentTarget.blur()}
      />
      <span className="kbd">/</span>
    </label>
  )
}
