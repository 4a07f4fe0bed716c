// The filters of the list: outcome chips with their counts, search, campaign, tag, label, method, user, date; all in the address.
import { clsx } from 'clsx'
import { IconPinned, IconTrash } from '@tabler/icons-react'
import { useQuery } from '@tanstack/react-query'
import { facetsQuery } from '../api/queries'
import { Chip, ChipCount, TextButton } from '../ui/Button'
import { MethodName } from '../ui/MethodMark'
import { SearchBox } from '../ui/SearchBox'
import { lookOf, OutcomeIcon } from '../ui/VerdictBadge'
import { ColumnsMenu } from './ColumnsMenu'
import { DateMenu } from './DateMenu'
import { FilterMenu } from '../overlay/FilterMenu'
import { CLEARED, isNarrowed, type RunsSearch, SHOWS, type Show } from './search'
import { layout } from '../ui/styles'

interface FiltersProps {
  search: RunsSearch
  counts: Record<string, number>
  onChange: (change: Partial<RunsSearch>) => void
}

/** The menus: their name, what they set, and which of the values that runs have they offer. */
const MENUS = [
  ['Campaign', 'campaign', 'campaigns'],
  ['Tag', 'tag', 'tags'],
  ['Label', 'label', 'labels'],
  ['Found by', 'method', 'methods'],
  ['User', 'owner', 'owners'],
] as const

export function Filters({ search, counts, onChange }: FiltersProps) {
  const { data: facets, isError } = useQuery(facetsQuery)
  const absent = facets ? undefined : isError ? 'They could not be loaded.' : 'They are loading.'
  return (
    <>
      <Outcomes search={search} counts={counts} onChange={onChange} />
      <div className={layout.filters}>
        <SearchBox
          label="Search runs"
          value={search.q ?? ''}
          begin={search.focus === 'search'}
          onChange={(q) => onChange({ q: q || undefined, focus: undefined })}
        />
        {MENUS.filter(([, key]) => key !== 'label' || facets?.labels.length || search.label).map(([name, key, from]) => (
          <FilterMenu
            key={key}
            name={name}
            absent={absent}
            options={facets?.[from] ?? []}
            value={search[key]}
            onChange={(value) => onChange({ [key]: value })}
            label={key === 'method' ? (method) => <MethodName method={method} /> : undefined}
          />
        ))}
        <DateMenu search={search} onChange={onChange} />
        {isNarrowed(search) && (
          <TextButton className="small" onClick={() => onChange(CLEARED)}>Clear all</TextButton>
        )}
        <span className={clsx(layout.row, layout.atend)}>
          <ColumnsMenu cols={search.cols} removed={search.removed === true} onChange={(cols) => onChange({ cols })} />
        </span>
      </div>
    </>
  )
}

function Outcomes({ search, counts, onChange }: FiltersProps) {
  const numberOf = (show: Show) => (counts[show] ?? 0) + (show === 'running' ? (counts.cancelling ?? 0) : 0)
  const shown = SHOWS.filter((show) => numberOf(show) > 0 || search.show === show)
  return (
    <div className={layout.filters}>
      <Chip on={!search.show && !search.removed} act={() => onChange({ show: undefined, removed: undefined })}>
        All {!search.removed && <ChipCount of={counts.total} />}
      </Chip>
      {shown.map((show) => (
        <Chip key={show} on={search.show === show} act={() => onChange({ show: search.show === show ? undefined : show })}>
          <span data-tone={lookOf(show).tone} style={{ color: 'var(--tone-solid, var(--tone))', display: 'flex' }}>
            <OutcomeIcon outcome={show} />
          </span>
          {lookOf(show).word} <ChipCount of={numberOf(show)} />
        </Chip>
      ))}
      <Chip on={search.pinned === true} act={() => onChange({ pinned: search.pinned ? undefined : true })}>
        <IconPinned className="i" aria-hidden /> Pinned
      </Chip>
      {(search.removed || (counts.removed ?? 0) > 0) && (
        <Chip on={search.removed === true} act={() => onChange({ removed: search.removed ? undefined : true, show: undefined })}>
          <IconTrash className="i" aria-hidden /> Removed <ChipCount of={counts.removed} />
        </Chip>
      )}
    </div>
  )
}
