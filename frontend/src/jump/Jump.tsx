// The search dialog (Ctrl K): runs found by the service, pages, library campaigns, help.
import { Combobox, Modal, useCombobox } from '@mantine/core'
import { useDebouncedValue } from '@mantine/hooks'
import { IconArrowRight, IconSearch } from '@tabler/icons-react'
import { keepPreviousData, useQuery } from '@tanstack/react-query'
import { useRouter } from '@tanstack/react-router'
import { clsx } from 'clsx'
import { type ReactNode, useEffect, useMemo, useState } from 'react'
import * as calls from '../api/calls'
import { catalogueQuery, libraryQuery } from '../api/queries'
import type { RunSummary } from '../client'
import type { OpenApi } from '../docs/openapi'
import { OutcomeIcon, lookOf, shownAs, wordOf } from '../ui/VerdictBadge'
import { Themed } from '../overlay/Themed'
import { useReturnFocus } from '../overlay/useReturnFocus'
import { typedEarly } from './early'
import { operationsIn, passagesWith, sectionsIn } from './passages'
import { kept, matching, type Place, placesOf } from './places'
import { buttons, layout } from '../ui/styles'
import styles from './jump.module.css'

/** Maximum number of runs shown. */
const RUNS = 6
/** Debounce interval of typing [ms]. */
const REST = 150

export function Jump({ opened, onClose }: { opened: boolean; onClose: () => void }) {
  useReturnFocus(opened)
  return (
    <Themed>
      <Modal.Root opened={opened} onClose={onClose} returnFocus={false} padding={0} size={560} yOffset="12vh" lockScroll={false}>
        <Modal.Overlay />
        <Modal.Content aria-label="Search or jump to">
          <Search onDone={onClose} />
        </Modal.Content>
      </Modal.Root>
    </Themed>
  )
}

function Search({ onDone }: { onDone: () => void }) {
  const router = useRouter()
  const [text, setText] = useState('')
  const store = useCombobox({ opened: true, onDropdownClose: onDone })
  const [words] = useDebouncedValue(text.trim(), REST)
  const found = useQuery({
    queryKey: ['jump', words],
    queryFn: () => calls.listRuns(words ? { q: words } : {}, null, RUNS),
    placeholderData: keepPreviousData,
  })
  const { data: library = [] } = useQuery(libraryQuery)
  const { data: catalogue } = useQuery(catalogueQuery)
  const places = useMemo(() => placesOf(library, catalogue), [library, catalogue])
  const stale = found.isPlaceholderData || words !== text.trim()
  const runs = stale ? kept(found.data?.items ?? [], text) : (found.data?.items ?? [])
  const passages = usePassages()
  const offered = [...matching(places, text), ...passages.flatMap((some) => passagesWith(some, text))]
  useEffect(() => {
    store.selectFirstOption()
    // Enter selects the first result, whatever was selected before.
  }, [text, found.data, passages]) // oxlint-disable-line react-hooks/exhaustive-deps
  const go = (to: string) => {
    onDone()
    void router.navigate({ href: to })
  }
  return (
    <Combobox store={store} onOptionSubmit={go}>
      <label className={clsx(layout.row, styles.jumpbox)}>
        <IconSearch className="i mut" aria-hidden />
        <Combobox.EventsTarget>
          <input
            className={layout.grow}
            data-autofocus
            type="search"
            value={text}
            placeholder="Run, campaign, method, component, page, help"
            aria-label="Search or jump to"
            autoComplete="off"
            onFocus={() => setText(text + typedEarly())}
            onChange={(event) => setText(event.target.value)}
          />
        </Combobox.EventsTarget>
        <kbd className={buttons.kbd}>Esc</kbd>
      </label>
      {/* It scrolls, so the keyboard must reach it. */}
      <Combobox.Options className={styles.jumplist} aria-label="Found" tabIndex={0}>
        <Group name={text.trim() ? 'Runs' : 'Latest runs'}>{runs.map((run) => runOption(run))}</Group>
        {(['Pages', 'Launch', 'Help', 'Guides', 'API'] as const).map((group) => (
          <Group key={group} name={group}>
            {offered.filter((place) => place.group === group).map((place) => placeOption(place))}
          </Group>
        ))}
        {(found.isError || (runs.length + offered.length === 0 && !stale && !found.isFetching)) && (
          // An option, because a list box without any is invalid.
          <Combobox.Option value="" disabled className={styles.none}>
            {found.isError ? `Runs could not be searched. ${found.error.message}` : 'No results'}
          </Combobox.Option>
        )}
      </Combobox.Options>
    </Combobox>
  )
}

/** The guides and the API, which are loaded with the first search. */
function usePassages() {
  const lasting = { staleTime: Number.POSITIVE_INFINITY }
  const guides = useQuery({ queryKey: ['guides'], queryFn: async () => sectionsIn((await import('../help/texts')).TEXTS), ...lasting })
  const { data: document } = useQuery({ queryKey: ['openapi'], queryFn: calls.getOpenApi, ...lasting })
  return useMemo(() => [guides.data ?? [], operationsIn(document as OpenApi | undefined)], [guides.data, document])
}

function Group({ name, children }: { name: string; children: readonly ReactNode[] }) {
  return children.length > 0 ? <Combobox.Group label={name}>{children}</Combobox.Group> : null
}

function runOption(run: RunSummary): ReactNode {
  const outcome = shownAs(run)
  return (
    <Combobox.Option key={run.id} value={`/runs/${run.id}`}>
      <span data-tone={lookOf(outcome).tone}>
        <OutcomeIcon outcome={outcome} className="i s" />
      </span>
      <span className={layout.cut}>{run.name}</span>
      <span className={clsx('sec', styles.what, layout.cut)}>
        {run.id} · {wordOf(run)} · {run.campaign_name}
      </span>
    </Combobox.Option>
  )
}

function placeOption({ to, name, note }: Place): ReactNode {
  return (
    <Combobox.Option key={to} value={to}>
      <IconArrowRight className="i s mut" aria-hidden />
      <span className={layout.cut}>{name}</span>
      <span className={clsx('sec', styles.what, layout.cut)}>{note}</span>
    </Combobox.Option>
  )
}
