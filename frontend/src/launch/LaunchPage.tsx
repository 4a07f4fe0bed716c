// Launching a run: choose a campaign, an earlier run or a draft, edit it as a form or as text, start it or keep it.
import { useQuery } from '@tanstack/react-query'
import { useNavigate, useSearch } from '@tanstack/react-router'
import { useMemo, useState } from 'react'
import { asCampaign } from '../api/campaign'
import { catalogueQuery, draftQuery, libraryQuery, runQuery } from '../api/queries'
import { Loading, Trouble } from '../app/Trouble'
import { useTitle } from '../app/useTitle'
import type { Draft } from '../client'
import { fromDraft, fromLibrary, fromRun, type Start } from './beginning'
import { Editor } from './Editor'
import './launch.css'
import { ordered, type Shelf, shelfOf } from './shelf'

/** An editor that has become a draft goes on as it is under the draft's address. */
interface Own {
  draft: string
  key: string
  start: Start
}

export function LaunchPage() {
  useTitle('New run')
  const search = useSearch({ from: '/launch' })
  const navigate = useNavigate()
  const [own, setOwn] = useState<Own | null>(null)
  const kept = own && own.draft === search.draft ? own : null
  const asked = kept ? undefined : search.draft
  const catalogue = useQuery(catalogueQuery)
  const library = useQuery(libraryQuery)
  const earlier = useQuery({ ...runQuery(search.from ?? ''), enabled: Boolean(search.from) })
  const draft = useQuery({ ...draftQuery(asked ?? ''), enabled: Boolean(asked) })
  const [shelf, setShelf] = useState<Shelf | null>(null)
  const campaigns = useMemo(() => ordered(library.data ?? []), [library.data])
  const chosen = search.from || search.draft ? null : (search.case ?? campaigns[0]?.id ?? null)

  const opened = useQuery({
    queryKey: ['opened', asked, draft.data?.version],
    queryFn: () => fromDraft(draft.data as Draft, asCampaign(campaigns[0]?.document)),
    enabled: Boolean(asked) && draft.data?.id === asked && campaigns.length > 0 && Boolean(catalogue.data),
    staleTime: Number.POSITIVE_INFINITY,
    gcTime: 0,
  })
  const start = useMemo(() => {
    if (kept) return kept.start
    if (asked) return opened.data
    if (search.from) return earlier.data && fromRun(earlier.data)
    const item = library.data?.find((campaign) => campaign.id === chosen)
    return item && fromLibrary(item)
  }, [kept, asked, opened.data, search.from, earlier.data, library.data, chosen])

  const failed = [library, catalogue, earlier, draft, opened].find((query) => query.isError)
  if (failed) return <Trouble error={failed.error} retry={() => void failed.refetch()} />
  if (catalogue.failureReason && !catalogue.data) return <Trouble error={catalogue.failureReason} />
  if (!library.data || !catalogue.data || !start) return <Loading what="campaigns" />
  const version = start.draft && `${start.draft.id}@${start.draft.version}`
  const key = kept?.key ?? version ?? search.from ?? chosen ?? ''
  return (
    <Editor
      // Another case starts a new editor; what was edited belongs to the old one.
      key={key}
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
      onKept={(saved) => {
        setOwn({ draft: saved.id, key, start })
        void navigate({ to: '/launch', search: { draft: saved.id, tab: search.tab }, replace: true })
      }}
      onReopen={() => {
        setOwn(null)
        void draft.refetch()
      }}
    />
  )
}
