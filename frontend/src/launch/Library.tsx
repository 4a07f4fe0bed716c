// The shipped campaigns as cards to choose from.
import type { KeyboardEvent } from 'react'
import { asCampaign, type Campaign } from '../api/campaign'
import type { Catalogue, LibraryCampaign } from '../client'
import { plain } from '../format/numbers'
import { Sign } from '../ui/Sign'
import { PlanView } from './PlanView'

interface LibraryProps {
  campaigns: LibraryCampaign[]
  catalogue: Catalogue | undefined
  chosen: string | null
  onChoose: (campaign: LibraryCampaign) => void
}

export function Library({ campaigns, catalogue, chosen, onChoose }: LibraryProps) {
  const keys = (event: KeyboardEvent, i: number) => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key]
    if (!step) return
    event.preventDefault()
    const next = campaigns[(i + step + campaigns.length) % campaigns.length]
    if (!next) return
    onChoose(next)
    document.getElementById(`case-${next.id}`)?.focus()
  }
  const shown = campaigns.find((item) => item.id === chosen)
  return (
    <div className="lib">
      <div className="cases" role="radiogroup" aria-label="Case">
        {campaigns.map((item, i) => (
          <Card
            key={item.id}
            item={item}
            catalogue={catalogue}
            chosen={item.id === chosen}
            tabbable={item.id === chosen || (chosen === null && i === 0)}
            onChoose={() => onChoose(item)}
            onKey={(event) => keys(event, i)}
          />
        ))}
      </div>
      {shown && <About campaign={asCampaign(shown.document)} />}
    </div>
  )
}

/** What the chosen campaign is about and where it comes from. */
function About({ campaign }: { campaign: Campaign }) {
  return (
    <div className="aboutcase">
      <h3>{campaign.name}</h3>
      {campaign.summary && <p>{campaign.summary}</p>}
      {campaign.notes && <p className="small mut">{campaign.notes}</p>}
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
  const criterion = catalogue?.components.find((c) => c.role === 'criterion' && c.name === campaign.criterion.component)
  const titles = (['vehicle', 'controller', 'avoider'] as const).map((role) => {
    const name = campaign.scenario[role].component
    return catalogue?.components.find((c) => c.role === role && c.name === name)?.title ?? name
  })
  return (
    <button
      type="button"
      id={`case-${item.id}`}
      className="libc"
      role="radio"
      aria-checked={chosen}
      tabIndex={tabbable ? 0 : -1}
      onClick={onChoose}
      onKeyDown={onKey}
    >
      <span className="pic">
        <PlanView campaign={campaign} />
      </span>
      <span className="tx">
        <span className="hd">
          {campaign.name}
          <span className="radio" aria-hidden />
        </span>
        <span className="small sec">{titles.join(', ')}</span>
        <span className="kv">
          <span className="mut">Criterion</span>
          <span className="num">
            <Sign text={criterion?.quantity || 'value'} /> &gt; {plain(Number(campaign.criterion.threshold))}{' '}
            {criterion?.unit}
          </span>
          <span className="mut">Uncertain parameters</span>
          <span className="num">{Object.keys(campaign.uncertain).length}</span>
        </span>
        {item.problems[0] && <span className="small bad-t">{item.problems[0].message}</span>}
      </span>
    </button>
  )
}
