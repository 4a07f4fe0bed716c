// Launching a run: choose a campaign, an earlier run or a draft, edit it as a form or as text, start it or save it as a draft.
import { useQuery, useQueryClient } from '@tanstack/react-query'
import { useNavigate, useSearch } from '@tanstack/react-router'
import { useMemo, useState } from 'react'
import { asCampaign } from '../api/campaign'
import { Refusal } from '../api/problems'
import { catalogueQuery, draftQuery, libraryQuery, runQuery } from '../api/queries'
import { Loading, Notice, Trouble } from '../page/Trouble'
import { useTitle } from '../page/useTitle'
import type { Draft, RunDetail } from '../client'
import { fromDraft, fromLibrary, fromRun, type Start } from './draft/beginning'
import { Editor } from './Editor'
import { ordered, type Shelf, shelfOf } from './library/shelf'
import { ButtonLink } from '../ui/Button'

/** An editor whose campaign was saved as a draft continues under the draft's address. */
interface Own {
  draft: string
  key: string
  start: Start
}

/** Without a worker there is no catalogue; the page polls until there is one. */
function Waiting() {
  return (
    <Notice
      title="Waiting for a worker"
      busy
      actions={<ButtonLink to="/runs">All runs</ButtonLink>}
    >
      Vehicles, controllers, avoiders and search methods are published by workers, and none has started on this database
      yet. Start one with <code>clearance worker</code>: this page then continues automatically.
    </Notice>
  )
}

/** The address names a campaign that the library does not have. */
function Absent({ id }: { id: string }) {
  return (
    <Notice
      title="Campaign not found"
      actions={<ButtonLink main to="/launch">Choose from the library</ButtonLink>}
    >
      The library of this installation has no campaign “{id}”.
    </Notice>
  )
}

export function LaunchPage() {
  useTitle('New run')
  const search = useSearch({ from: '/launch' })
  const navigate = useNavigate()
  const cache = useQueryClient()
  const [own, setOwn] = useState<Own | null>(null)
  const kept = own && own.draft === search.draft ? own : null
  const unopened = kept ? undefined : search.draft
  const catalogue = useQuery(catalogueQuery)
  const library = useQuery(libraryQuery)
  const earlier = useQuery({ ...runQuery(search.from ?? ''), enabled: Boolean(search.from) })
  const draft = useQuery({ ...draftQuery(unopened ?? ''), enabled: Boolean(unopened) })
  const [shelf, setShelf] = useState<Shelf | null>(null)
  const campaigns = useMemo(() => ordered(library.data ?? []), [library.data])
  const chosen = search.from || search.draft ? null : (search.case ?? campaigns[0]?.id ?? null)

  const once = { staleTime: Number.POSITIVE_INFINITY, gcTime: 0 }
  const opened = useQuery({
    queryKey: ['opened', unopened, draft.data?.version],
    queryFn: () => fromDraft(draft.data as Draft, asCampaign(campaigns[0]?.document)),
    enabled: Boolean(unopened) && draft.data?.id === unopened && campaigns.length > 0 && Boolean(catalogue.data),
    ...once,
  })
  const again = useQuery({
    queryKey: ['again', search.from, search.remedy],
    queryFn: () => fromRun(earlier.data as RunDetail, search.remedy),
    enabled: Boolean(search.from) && earlier.data?.id === search.from && Boolean(catalogue.data),
    ...once,
  })
  const start = useMemo(() => {
    if (kept) return kept.start
    if (unopened) return opened.data
    if (search.from) return again.data
    const item = library.data?.find((campaign) => campaign.id === chosen)
    return item && fromLibrary(item)
  }, [kept, unopened, opened.data, search.from, again.data, library.data, chosen])

  // What was read once stays when it cannot be read again: an editor must not vanish with what was typed.
  const asks = [library, catalogue, earlier, draft, opened, again]
  const failed = asks.find((query) => query.isError && !query.data)
  if (failed) return <Trouble error={failed.error} retry={() => void failed.refetch()} />
  if (!catalogue.data && catalogue.failureReason instanceof Refusal && catalogue.failureReason.status === 503) return <Waiting />
  if (chosen && !kept && library.data && !start) return <Absent id={chosen} />
  if (!library.data || !catalogue.data || !start) return <Loading what="campaigns" title="New run" failed={asks.find((query) => query.failureReason)?.failureReason} />
  const version = start.draft && `${start.draft.id}@${start.draft.version}`
  const key = kept?.key ?? version ?? (search.from && [search.from, search.remedy].join()) ?? chosen ?? ''
  return (
    <Editor
      // Another case starts a new editor; edits belong to the old one.
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
        void cache.resetQueries({ queryKey: ['draft', search.draft] })
      }}
    />
  )
}
