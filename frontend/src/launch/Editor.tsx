// The form and the text of one campaign, the problems of both, and the start of the run.
import { IconAlertTriangle, IconArrowBackUp, IconArrowForwardUp } from '@tabler/icons-react'
import { useMutation, useQueryClient } from '@tanstack/react-query'
import { useNavigate } from '@tanstack/react-router'
import { clsx } from 'clsx'
import { useMemo, useRef, useState } from 'react'
import { useBarred } from '../api/may'
import { checkCampaign, submitRun } from '../api/calls'
import { asCampaign, hasScenario } from '../api/campaign'
import { useKey } from '../api/keys'
import { type FieldProblem, Refusal } from '../api/problems'
import type { Catalogue, Draft, LibraryCampaign } from '../client'
import { Skipped } from '../page/Skipped'
import { Seg } from '../ui/Card'
import { IconButton } from '../ui/IconButton'
import { SectionTabs } from '../ui/SectionTabs'
import { useHotkeys } from '../ui/useHotkeys'
import type { Start } from './draft/beginning'
import { CampaignForm, tabsOf } from './form/CampaignForm'
import { DraftBar } from './draft/DraftBar'
import { Drafts } from './draft/Drafts'
import { Heading } from './Heading'
import { Leaving } from './draft/Leaving'
import { Library } from './library/Library'
import { criterionOf, decidingOf, parametersOf } from './campaign/parameters'
import { PreviewCard } from './preview/PreviewCard'
import { focusField, ProblemsProvider } from './fields/problems'
import { useRegression } from './regression/regression'
import type { Shelf } from './library/shelf'
import { Estimate, RunCard } from './Side'
import { StartBar } from './StartBar'
import { Summary } from './Summary'
import { SweepCard } from './sweep/SweepCard'
import { type Draft as DraftState, useDraft } from './draft/useDraft'
import { isAnother, useNames } from './draft/useNames'
import { usePreview } from './preview/usePreview'
import { useSaved } from './draft/useSaved'
import { YamlEditor } from './YamlEditor'
import { cards, layout } from '../ui/styles'
import styles from './launch.module.css'

interface EditorProps {
  start: Start
  from: string | undefined
  catalogue: Catalogue
  library: LibraryCampaign[]
  chosen: string | null
  shelf: Shelf
  onShelf: (shelf: Shelf) => void
  tab: 'form' | 'yaml'
  onChoose: (id: string) => void
  onTab: (tab: 'yaml' | undefined) => void
  /** Stored as a draft, which has its own address. */
  onKept: (draft: Draft) => void
  /** Reload the draft and discard edits. */
  onReopen: () => void
}

export function Editor(props: EditorProps) {
  const { start, from, catalogue, library, chosen, shelf, onShelf, tab, onChoose, onTab } = props
  const draft = useDraft(start)
  const { name, tags, setName, setTags, replace } = useNames(start, draft.campaign)
  const regression = useRegression(start)
  const [remove, setRemove] = useState(false)
  const navigate = useNavigate()
  const cache = useQueryClient()
  const current = JSON.stringify([draft.edits, name, tags])
  const [seen, setSeen] = useState(current)
  const sent = useRef(current)
  const going = useRef<{ pathname: string; draft?: string } | null>(null)
  const saved = useSaved(
    start.draft,
    async () => {
      sent.current = current // what is typed from here on is not saved
      return { name: name.trim(), tags, text: await draft.typed() }
    },
    (kept) => {
      setSeen(sent.current)
      going.current = { pathname: '/launch', draft: kept.id }
      props.onKept(kept)
    },
  )
  const keyOf = useKey()
  const launch = useMutation({
    mutationFn: async () => {
      const text = await draft.typed()
      const checked = await checkCampaign(text)
      if (!checked.ok) throw new Refusal(422, 'The campaign has problems', '', checked.problems)
      const request = { campaign: asCampaign(checked.document), name: name.trim(), tags, ...regression.request, text }
      const run = await submitRun(request, keyOf(request))
      // The run takes precedence: a draft that another user has saved in the meantime is not changed.
      await saved.launched(run.id, remove).catch(() => undefined)
      return run
    },
    onSuccess: (run) => {
      going.current = { pathname: `/runs/${run.id}` }
      void cache.invalidateQueries({ queryKey: ['runs'] })
      void navigate({ to: '/runs/$id', params: { id: run.id } })
    },
    onError: () => document.getElementById('problems')?.scrollIntoView({ block: 'center' }),
  })
  const refused = launch.error instanceof Refusal ? launch.error : null
  const problems = draft.checking || !refused ? draft.problems : merged(draft.problems, refused.errors)
  const parameters = useMemo(() => parametersOf(draft.campaign, catalogue), [draft.campaign, catalogue])
  const criterion = criterionOf(draft.campaign, catalogue)
  const ok = draft.problems.length === 0
  const live = usePreview(draft.checked, !draft.checking)
  const wrong = regression.problem.labels || regression.problem.baseline
  const barred = useBarred('engineer')
  const blocked = name.trim() === '' || !ok || wrong !== '' || barred !== undefined
  const begin = () => {
    if (!blocked && !launch.isPending) launch.mutate()
  }
  useHotkeys({ 'Ctrl+Enter': begin })
  const [jump, setJump] = useState<{ field: string } | null>(null)
  const toText = (field: string) => {
    setJump({ field })
    onTab('yaml')
  }
  const toForm = (field: string) => {
    onTab(undefined)
    requestAnimationFrame(() => focusField(field))
  }
  const why = barred !== undefined ? barred : name.trim() === '' ? 'Give the run a name.' : ok ? wrong : problems.length === 1 ? 'Solve the problem first.' : `Solve the ${problems.length} problems first.`
  return (
    <ProblemsProvider value={problems}>
      <Leaving
        dirty={current !== seen}
        expected={({ pathname, search }) => going.current?.pathname === pathname && going.current.draft === search.draft}
        onSave={() => saved.save({ leaving: true })}
      />
      <Heading from={from} changed={start.changed} baseline={start.baseline} draft={saved.draft} />
      <Skipped unusable={catalogue.unusable} />
      {!from && !saved.draft && (
        <>
          <Drafts />
          <h2 className={layout.sect}>Case</h2>
          <Library
            campaigns={library}
            catalogue={catalogue}
            chosen={chosen}
            shelf={shelf}
            onShelf={onShelf}
            onChoose={(campaign) => onChoose(campaign.id)}
          />
        </>
      )}
      <div className={clsx(layout.row, styles.tabs)}>
        <Seg
          label="How to edit"
          tall
          options={{ form: 'Form', yaml: 'YAML' }}
          value={tab}
          onChange={(value) => onTab(value === 'yaml' ? 'yaml' : undefined)}
        />
        <span className="small mut">Both edit the same campaign</span>
        <Back draft={draft} />
      </div>
      {tab === 'form' && draft.readable && <SectionTabs sections={tabsOf(draft.campaign)} />}
      <div className={styles.launch} data-touch>
        <div className={layout.stack}>
          {tab === 'yaml' ? (
            <YamlEditor
              text={draft.text}
              ok={ok}
              checking={draft.checking}
              problems={problems}
              campaign={draft.campaign}
              catalogue={catalogue}
              jump={jump}
              onChange={(text, how) => {
                const another = how === 'replaced' || isAnother(draft.text, text)
                if (another && text !== draft.text) replace()
                draft.setText(text, another ? 'replaced' : 'typed')
              }}
              onUndo={() => draft.undo?.()}
              onRedo={() => draft.redo?.()}
              onForm={toForm}
            />
          ) : draft.readable ? (
            <CampaignForm campaign={draft.campaign} set={draft.set} remove={draft.remove} catalogue={catalogue} parameters={parameters} />
          ) : (
            <p className={clsx(cards.note, cards.warn)}>
              <IconAlertTriangle className="i" aria-hidden />
              The text cannot be read as a campaign, so there is no form of it yet. Solve its problems in the YAML tab.
            </p>
          )}
        </div>
        <div className={clsx(layout.stack, styles.side, !hasScenario(draft.campaign) && styles.unpaired)}>
          <RunCard
            name={name}
            tags={tags}
            campaign={draft.campaign}
            readable={draft.readable}
            criterion={decidingOf(draft.campaign, catalogue)}
            regression={regression}
            onName={setName}
            onTags={setTags}
            set={draft.set}
          />
          <div className={clsx(layout.stack, styles.stuck)}>
            <Summary
              problems={problems}
              trouble={draft.trouble ?? (refused?.errors.length ? null : launch.error)}
              recheck={draft.recheck}
              tab={tab}
              onForm={toForm}
              onText={toText}
            />
            {(draft.readable || start.readable) && hasScenario(draft.campaign) && (
              <PreviewCard
                campaign={draft.campaign}
                catalogue={catalogue}
                criterion={criterion}
                readable={draft.readable}
                ok={ok}
                live={live}
              />
            )}
            {draft.readable && <Estimate checked={draft.checked} campaign={draft.campaign} />}
            <DraftBar
              saved={saved}
              dirty={current !== seen}
              remove={remove}
              onRemove={setRemove}
              onReopen={props.onReopen}
            />
            {draft.readable && (
              <SweepCard
                campaign={draft.campaign}
                parameters={parameters}
                name={name.trim()}
                tags={tags}
                labels={regression.request.labels}
                blocked={blocked}
                typed={draft.typed}
                onLaunched={(id) => {
                  going.current = { pathname: `/sweeps/${id}` }
                  void cache.invalidateQueries({ queryKey: ['runs'] })
                  void navigate({ to: '/sweeps/$id', params: { id } })
                }}
              />
            )}
          </div>
        </div>
      </div>
      <StartBar
        checked={draft.checked}
        checking={draft.checking}
        failed={draft.trouble !== null}
        disabled={blocked}
        busy={launch.isPending}
        why={why}
        onStart={begin}
      />
    </ProblemsProvider>
  )
}

/** Undoes edits of form and text. */
function Back({ draft }: { draft: DraftState }) {
  return (
    <span className={styles.back}>
      <IconButton bare large label="Undo" title="Undo the last edit" icon={IconArrowBackUp} off={!draft.undo} act={() => draft.undo?.()} />
      <IconButton bare large label="Redo" icon={IconArrowForwardUp} off={!draft.redo} act={() => draft.redo?.()} />
    </span>
  )
}

function merged(live: readonly FieldProblem[], refused: readonly FieldProblem[]): FieldProblem[] {
  const known = new Set(live.map((problem) => problem.field + problem.message))
  return [...live, ...refused.filter((problem) => !known.has(problem.field + problem.message))]
}
