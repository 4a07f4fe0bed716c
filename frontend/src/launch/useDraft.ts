// The campaign being prepared: form and text edit the same one, and the service checks it while it changes.
// Whatever was edited last is the source; the other side follows what the service made of it. Start: `useDraft`.
import { keepPreviousData, useQuery } from '@tanstack/react-query'
import { useEffect, useState } from 'react'
import { checkCampaign } from '../api/calls'
import { asCampaign, type Campaign, write } from '../api/campaign'
import type { FieldProblem } from '../api/problems'
import type { Checked } from '../client'

const PAUSE = 300

export interface Draft {
  campaign: Campaign
  /** What the text tab shows. */
  text: string
  /** Whether the form shows the same campaign as the text: not while the text cannot be read. */
  readable: boolean
  checked: Checked | undefined
  /** The answer below belongs to an earlier state than the one shown. */
  checking: boolean
  problems: readonly FieldProblem[]
  /** Which side was edited last. */
  source: 'form' | 'text'
  /** Why it could not be checked at all. */
  trouble: Error | null
  /** How often it was edited. */
  edits: number
  set: (at: readonly (string | number)[], value: unknown) => void
  /** Several changes that belong together. */
  change: (change: (campaign: Campaign) => Campaign) => void
  setText: (text: string) => void
  /** The campaign as text to be kept: as it was typed, else as YAML; as JSON while the form holds what is no campaign. */
  typed: () => Promise<string>
}

/** What an editor begins with. */
export interface Beginning {
  campaign: Campaign
  /** Null: the text follows the form. */
  text: string | null
  /** `text`: the campaign is another one, because the text cannot be read as one. */
  source: 'form' | 'text'
}

interface State {
  campaign: Campaign
  /** Null: the text follows the form. */
  text: string | null
  source: 'form' | 'text'
  edits: number
  /** The document last read from the text. */
  read?: unknown
}

function useSettled<T>(value: T): T {
  const [settled, setSettled] = useState(value)
  useEffect(() => {
    const timer = setTimeout(() => setSettled(value), PAUSE)
    return () => clearTimeout(timer)
  }, [value])
  return settled
}

export function useDraft(first: Beginning): Draft {
  const [state, setState] = useState<State>({ ...first, edits: 0 })
  const change = (made: (campaign: Campaign) => Campaign) =>
    setState((before) => ({ campaign: made(before.campaign), text: null, source: 'form', edits: before.edits + 1 }))
  const given = state.source === 'text' ? (state.text ?? '') : state.campaign
  const settled = useSettled(given)
  const check = useQuery({
    queryKey: ['check', settled],
    queryFn: ({ signal }) => checkCampaign(settled, signal),
    placeholderData: keepPreviousData,
    staleTime: 60_000,
    gcTime: 60_000,
  })
  const fresh = settled === given && !check.isPlaceholderData
  const checked = check.data
  const document = state.source === 'text' && fresh ? checked?.document : undefined
  // Adjusted while rendering, so that no picture of the old campaign is shown in between.
  if (document && document !== state.read) setState({ ...state, campaign: asCampaign(document), read: document })
  return {
    campaign: state.campaign,
    text: state.text ?? (checked?.yaml && fresh ? checked.yaml : JSON.stringify(state.campaign, null, 2)),
    readable: state.source === 'form' || (!checked && state.edits > 0) || Boolean(checked?.document),
    checked,
    checking: !fresh || check.isFetching,
    problems: checked?.problems ?? [],
    source: state.source,
    trouble: check.error,
    edits: state.edits,
    set: (at, value) => change((campaign) => write(campaign, at, value)),
    change,
    setText: (text) => setState((before) => ({ ...before, text, source: 'text', edits: before.edits + 1 })),
    typed: async () => {
      if (state.text !== null) return state.text
      const { yaml } = await checkCampaign(state.campaign)
      return yaml ?? JSON.stringify(state.campaign, null, 2)
    },
  }
}
