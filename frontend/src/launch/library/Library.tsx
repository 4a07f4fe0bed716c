// The shipped campaigns as cards to choose from; with filters by tag and words.
import { IconChevronDown, IconSearch } from '@tabler/icons-react'
import { clsx } from 'clsx'
import type { KeyboardEvent } from 'react'
import { asCampaign, type Campaign } from '../../api/campaign'
import type { Catalogue, LibraryCampaign } from '../../client'
import { count, decimalsApart, exact, fixed } from '../../format/numbers'
import { unitText } from '../../format/units'
import { Button, Chip, ChipCount } from '../../ui/Button'
import { Sign } from '../../ui/Sign'
import { criterionOf } from '../campaign/parameters'
import { PlanView } from '../plan/PlanView'
import { Key, Legend } from '../plan/scene'
import { FEW, matching, type Shelf, tagsOf, titlesOf } from './shelf'
import { cards, fields, layout, lists } from '../../ui/styles'
import styles from './library.module.css'

interface LibraryProps {
  campaigns: LibraryCampaign[]
  catalogue: Catalogue | undefined
  chosen: string | null
  shelf: Shelf
  onShelf: (shelf: Shelf) => void
  onChoose: (campaign: LibraryCampaign) => void
}

export function Library({ campaigns, catalogue, chosen, shelf, onShelf, onChoose }: LibraryProps) {
  const found = matching(campaigns, shelf, catalogue)
  const shown = shelf.whole ? found : around(found, chosen)
  const about = campaigns.find((item) => item.id === chosen)
  const keys = (event: KeyboardEvent, i: number) => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key]
    if (!step) return
    event.preventDefault()
    const next = shown[(i + step + shown.length) % shown.length]
    if (!next) return
    onChoose(next)
    document.getElementById(`case-${next.id}`)?.focus()
  }
  const first = shown.some((item) => item.id === chosen) ? chosen : shown[0]?.id
  return (
    <div className={styles.lib}>
      {campaigns.length > FEW && (
        <Shelves campaigns={campaigns} shelf={shelf} onChange={(next) => onShelf({ ...next, whole: false })} />
      )}
      <div className={styles.cases} role="radiogroup" aria-label="Case">
        {shown.map((item, i) => (
          <Card
            key={item.id}
            item={item}
            catalogue={catalogue}
            chosen={item.id === chosen}
            tabbable={item.id === first}
            onChoose={() => onChoose(item)}
            onKey={(event) => keys(event, i)}
          />
        ))}
      </div>
      {found.length === 0 ? <p className="sec">No campaign in the library matches.</p> : <Lines shown={shown} />}
      {shown.length < found.length && (
        <Button small icon={IconChevronDown} onClick={() => onShelf({ ...shelf, whole: true })}>
          Show {count(found.length - shown.length)} more
        </Button>
      )}
      {about && <About campaign={asCampaign(about.document)} />}
    </div>
  )
}

/** The first few, and the chosen one. */
function around(found: LibraryCampaign[], chosen: string | null): LibraryCampaign[] {
  return found.filter((item, i) => i < FEW || item.id === chosen)
}

interface ShelvesProps {
  campaigns: LibraryCampaign[]
  shelf: Shelf
  onChange: (shelf: Shelf) => void
}

function Shelves({ campaigns, shelf, onChange }: ShelvesProps) {
  return (
    <div className={clsx(layout.filters, styles.shelves)}>
      <Chip on={shelf.tag === null} act={() => onChange({ ...shelf, tag: null })}>
        All <ChipCount of={campaigns.length} />
      </Chip>
      {tagsOf(campaigns).map(({ tag, count: n }) => (
        <Chip key={tag} on={shelf.tag === tag} act={() => onChange({ ...shelf, tag: shelf.tag === tag ? null : tag })}>
          {tag} <ChipCount of={n} />
        </Chip>
      ))}
      <span className={clsx(fields.inp, fields.search)}>
        <IconSearch className="i s" aria-hidden />
        <input
          type="search"
          aria-label="Search the library"
          placeholder="Search the library"
          value={shelf.words}
          onChange={(event) => onChange({ ...shelf, words: event.target.value, tag: event.target.value ? null : shelf.tag })}
        />
      </span>
    </div>
  )
}

/** What the pictures show, as far as the shown ones have it. */
function Lines({ shown }: { shown: readonly LibraryCampaign[] }) {
  const flights = shown.flatMap(({ nominal }) => nominal ?? [])
  if (flights.length === 0) return null
  return (
    <Legend>
      <Key colour="--c-nom">Nominal path, simulated</Key>
      {flights.some(({ tracks }) => tracks.length > 0) && <Key colour="--c-obs" dash="5 3">Path of an obstacle</Key>}
      <Key colour="--c-crit" dash="3 2">Required distance at the closest approach</Key>
      <Key colour="--ink">Closest approach</Key>
    </Legend>
  )
}

/** Description and source of the chosen campaign. */
function About({ campaign }: { campaign: Campaign }) {
  return (
    <div className={styles.aboutcase}>
      <h3>{campaign.name}</h3>
      {campaign.summary && <p>{campaign.summary}</p>}
      {campaign.notes && (
        <details>
          <summary className="sec small">Source, what is reconstructed, limits</summary>
          <p className="small mut">{campaign.notes}</p>
        </details>
      )}
    </div>
  )
}

interface CardProps {
  item: LibraryCampaign
  catalogue: Catalogue | undefined
  chosen: boolean
  tabbable: boolean
  onChoose: () => void
  onKey: (event: KeyboardEvent) => void
}

function Card({ item, catalogue, chosen, tabbable, onChoose, onKey }: CardProps) {
  const campaign = asCampaign(item.document)
  const criterion = criterionOf(campaign, catalogue)
  const { nominal } = item
  const threshold = Number(campaign.criterion.threshold)
  const high = criterion?.worse === 'high'
  const value = nominal?.value ?? null
  const clear = value === null || (high ? value < threshold : value > threshold)
  return (
    <button
      type="button"
      id={`case-${item.id}`}
      className={clsx(cards.card, styles.libc)}
      role="radio"
      aria-checked={chosen}
      tabIndex={tabbable ? 0 : -1}
      onClick={onChoose}
      onKeyDown={onKey}
    >
      <span className={styles.pic}>
        <PlanView campaign={campaign} catalogue={catalogue} flight={nominal} clear={clear} />
      </span>
      <span className={styles.tx}>
        <span className={clsx(layout.row, 'b', styles.hd)}>
          {campaign.name}
          <span className={styles.radio} aria-hidden />
        </span>
        <span className="small sec">{titlesOf(campaign, catalogue).join(' \u00b7 ')}</span>
        <span className={clsx(lists.kv, styles.kv)}>
          <span className="mut">Criterion</span>
          <span className="num">
            <Sign text={criterion?.quantity || 'value'} /> {high ? '<' : '>'} {exact(threshold)} {unitText(criterion?.unit ?? '')}
          </span>
          {value !== null && (
            <>
              <span className="mut">Nominal</span>
              <span className={clear ? 'num' : 'num bad-t'}>
                {fixed(value, decimalsApart([value, threshold]))} {unitText(criterion?.unit ?? '')}
                {!clear && ', violates'}
              </span>
            </>
          )}
          <span className="mut">Uncertain parameters</span>
          <span className="num">{Object.keys(campaign.uncertain).length}</span>
        </span>
        {nominal && nominal.status !== 'ok' && (
          <span className="small bad-t">
            The nominal case is {nominal.status}: {nominal.reason || 'the reason is unknown'}.
          </span>
        )}
        {item.problems[0] && <span className="small bad-t">{item.problems[0].message}</span>}
      </span>
    </button>
  )
}
