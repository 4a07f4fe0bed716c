// The form and the text of one campaign, the problems of both, and the start of the run.
import { IconAlertTriangle, IconCopy } from '@tabler/icons-react'
import { useMutation, useQueryClient } from '@tanstack/react-query'
import { Link, useNavigate } from '@tanstack/react-router'
import { useMemo, useRef, useState } from 'react'
import { checkCampaign, submitRun } from '../api/calls'
import type { Campaign } from '../api/campaign'
import { type FieldProblem, Refusal } from '../api/problems'
import type { Catalogue, LibraryCampaign } from '../client'
import { Seg } from '../ui/Card'
import { useHotkeys } from '../ui/useHotkeys'
import { Library } from './Library'
import { MethodsTable } from './MethodsTable'
import type { Shelf } from './shelf'
import { parametersOf } from './parameters'
import { PreviewCard } from './PreviewCard'
import { ProblemsProvider } from './problems'
import { ScenarioForm } from './ScenarioForm'
import { SettingsForm } from './SettingsForm'
import { Estimate, RunCard, StartButton } from './Side'
import { Summary } from './Summary'
import { UncertainTable } from './UncertainTable'
import { useDraft } from './useDraft'
import { usePreview } from './usePreview'
import { YamlEditor } from './YamlEditor'

interface EditorProps {
  start: { campaign: Campaign; text: string | null; name: string; tags: string[] }
  from: string | undefined
  catalogue: Catalogue
  library: LibraryCampaign[]
  chosen: string | null
  shelf: Shelf
  onShelf: (shelf: Shelf) => void
  tab: 'form' | 'yaml'
  onChoose: (id: string) => void
  onTab: (tab: 'yaml' | undefined) => void
}

export function Editor({ start, from, catalogue, library, chosen, shelf, onShelf, tab, onChoose, onTab }: EditorProps) {
  const draft = useDraft(start.campaign, start.text)
  const [name, setName] = useState(start.name)
  const [tags, setTags] = useState(start.tags)
  const navigate = useNavigate()
  const cache = useQueryClient()
  // One key for one campaign as it stands: pressing twice never starts two runs.
  const submission = useRef({ body: '', key: '' })
  const launch = useMutation({
    mutationFn: async () => {
      const checked = draft.source === 'text' ? await checkCampaign(draft.text) : null
      if (checked && !checked.ok) throw new Refusal(422, 'The campaign has problems', '', checked.problems)
      const given = { campaign: (checked?.document as Campaign | undefined) ?? draft.campaign, name: name.trim(), tags }
      const body = JSON.stringify(given)
      if (submission.current.body !== body) submission.current = { body, key: crypto.randomUUID() }
      return submitRun(given, submission.current.key)
    },
    onSuccess: (run) => {
      void cache.invalidateQueries({ queryKey: ['runs'] })
      void navigate({ to: '/runs/$id', params: { id: run.id } })
    },
    onError: () => document.getElementById('problems')?.scrollIntoView({ block: 'center' }),
  })
  const refused = launch.error instanceof Refusal ? launch.error : null
  const problems = draft.checking || !refused ? draft.problems : merged(draft.problems, refused.errors)
  const parameters = useMemo(() => parametersOf(draft.campaign, catalogue), [draft.campaign, catalogue])
  const criterion = catalogue.components.find(
    (c) => c.role === 'criterion' && c.name === draft.campaign.criterion.component,
  )
  const live = usePreview(draft.checked, !draft.checking)
  const blocked = name.trim() === '' || draft.problems.length > 0
  const begin = () => {
    if (!blocked && !launch.isPending) launch.mutate()
  }
  useHotkeys({ 'Ctrl+Enter': begin })
  const why =
    name.trim() === '' ? 'Give the run a name.' : draft.problems.length > 0 ? 'Solve the problems above first.' : ''
  return (
    <ProblemsProvider value={problems}>
      <div className="ph">
        <div className="t">
          <h1>New run</h1>
        </div>
        {from && (
          <span className="note">
            <IconCopy className="i" aria-hidden />
            <span>
              Starts from{' '}
              <Link to="/runs/$id" params={{ id: from }}>
                {from}
              </Link>
              . <Link to="/launch">Choose from the library instead</Link>
            </span>
          </span>
        )}
      </div>
      {!from && (
        <>
          <h2 className="sect">Case</h2>
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
      <div className="tabs">
        <Seg
          label="How to edit"
          tall
          options={[
            { value: 'form', label: 'Form' },
            { value: 'yaml', label: 'YAML' },
          ]}
          value={tab}
          onChange={(value) => onTab(value === 'yaml' ? 'yaml' : undefined)}
        />
        <span className="small mut">Both edit the same campaign</span>
      </div>
      <div className="launch">
        <div className="stack">
          {tab === 'yaml' ? (
            <YamlEditor
              text={draft.text}
              ok={draft.problems.length === 0}
              checking={draft.checking}
              problems={draft.problems}
              onChange={draft.setText}
            />
          ) : draft.readable ? (
            <>
              <UncertainTable campaign={draft.campaign} parameters={parameters} set={draft.set} />
              <MethodsTable campaign={draft.campaign} catalogue={catalogue} parameters={parameters} set={draft.set} />
              <SettingsForm campaign={draft.campaign} set={draft.set} />
              <ScenarioForm campaign={draft.campaign} catalogue={catalogue} set={draft.set} />
            </>
          ) : (
            <p className="note warn">
              <IconAlertTriangle className="i" aria-hidden />
              The text cannot be read as a campaign, so there is no form of it yet. Solve its problems in the YAML tab.
            </p>
          )}
        </div>
        <div className="stack side">
          <RunCard
            name={name}
            tags={tags}
            campaign={draft.campaign}
            readable={draft.readable}
            criterion={criterion}
            onName={setName}
            onTags={setTags}
            set={draft.set}
          />
          <div className="stack stuck">
          <PreviewCard campaign={draft.campaign} catalogue={catalogue} criterion={criterion} readable={draft.readable} ok={draft.problems.length === 0} live={live} />
          <Estimate checked={draft.checked} campaign={draft.campaign} />
          <Summary
            problems={problems}
            trouble={draft.trouble ?? (refused?.errors.length ? null : launch.error)}
            onForm={() => onTab(undefined)}
          />
          <StartButton disabled={blocked} busy={launch.isPending} why={why} onStart={begin} />
          </div>
        </div>
      </div>
    </ProblemsProvider>
  )
}

function merged(live: readonly FieldProblem[], refused: readonly FieldProblem[]): FieldProblem[] {
  const known = new Set(live.map((problem) => problem.field + problem.message))
  return [...live, ...refused.filter((problem) => !known.has(problem.field + problem.message))]
}
