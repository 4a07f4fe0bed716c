// Launching a run: choose a campaign, edit it as a form or as text, start it.
import { useQuery } from '@tanstack/react-query'
import { useNavigate, useSearch } from '@tanstack/react-router'
import { useMemo, useState } from 'react'
import { asCampaign } from '../api/campaign'
import { catalogueQuery, libraryQuery, runQuery } from '../api/queries'
import { Loading, Trouble } from '../app/Trouble'
import { useTitle } from '../app/useTitle'
import { Editor } from './Editor'
import './launch.css'
import { ordered, type Shelf, shelfOf } from './shelf'

export function LaunchPage() {
  useTitle('New run')
  const search = useSearch({ from: '/launch' })
  const navigate = useNavigate()
  const catalogue = useQuery(catalogueQuery)
  const library = useQuery(libraryQuery)
  const earlier = useQuery({ ...runQuery(search.from ?? ''), enabled: Boolean(search.from) })
  const [shelf, setShelf] = useState<Shelf | null>(null)
  const campaigns = useMemo(() => ordered(library.data ?? []), [library.data])
  const chosen = search.from ? null : (search.case ?? campaigns[0]?.id ?? null)

  const start = useMemo(() => {
    if (search.from) {
      const run = earlier.data
      return run && { campaign: asCampaign(run.campaign), text: null, name: run.name, tags: run.tags }
    }
    const item = library.data?.find((campaign) => campaign.id === chosen)
    if (!item) return undefined
    const campaign = asCampaign(item.document)
    return { campaign, text: item.yaml, name: campaign.name, tags: campaign.tags ?? [] }
  }, [search.from, earlier.data, library.data, chosen])

  const failed = [library, catalogue, earlier].find((query) => query.isError)
  if (failed) return <Trouble error={failed.error} retry={() => void failed.refetch()} />
  if (catalogue.failureReason && !catalogue.data) return <Trouble error={catalogue.failureReason} />
  if (!library.data || !catalogue.data || !start) return <Loading what="campaigns" />
  return (
    <Editor
      // Another case starts a new editor; what was edited belongs to the old one.
      key={search.from ?? chosen}
      start={start}
      from={search.from}
      catalogue={catalogue.data}
      library={campaigns}
      chosen={chosen}
      shelf={shelf ?? shelfOf(campaigns, chosen)}
      onShelf={setShelf}
      tab={search.tab ?? 'form'}
      onChoose={(id) => void navigate({ to: '/launch', search: { case: id, tab: search.tab }, replace: true })}
      onTab={(tab) => void navigate({ to: '/launch', search: { ...search, tab }, replace: true })}
    />
  )
}
