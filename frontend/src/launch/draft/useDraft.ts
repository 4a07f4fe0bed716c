// The campaign being prepared. Its text is what counts: an edit in the form changes it in its place, and what the service
// reads in it is what the form shows. Start reading at `useDraft`.
import { keepPreviousData, useQuery } from '@tanstack/react-query'
import { useEffect, useState } from 'react'
import { checkCampaign } from '../../api/calls'
import { schemaQuery } from '../../api/queries'
import { asCampaign, type Campaign, type List, without, write } from '../../api/campaign'
import type { FieldProblem } from '../../api/problems'
import type { Checked } from '../../client'
import { type History, NOTHING, recorded, redo, undo, type Version } from './history'

const PAUSE = 300

export interface Draft {
  campaign: Campaign
  text: string
  /** Whether the form shows the same campaign as the text: not while the text cannot be read as one. */
  readable: boolean
  checked: Checked | undefined
  /** The answer below belongs to an earlier state than the one shown. */
  checking: boolean
  problems: readonly FieldProblem[]
  /** Why it could not be checked at all, or its text not be changed. */
  trouble: Error | null
  /** How often it was edited. */
  edits: number
  set: (at: readonly (string | number)[], value: unknown) => void
  /** Takes a part out of a list, with all that is said of it. */
  remove: (list: List | 'objectives', index: number) => void
  setText: (text: string, how?: 'typed' | 'replaced') => void
  undo: (() => void) | null
  redo: (() => void) | null
  /** The text, once every edit is in it. */
  typed: () => Promise<string>
}

/** What an editor begins with. */
export interface Beginning {
  /** What the text means, or what the form shows of it; where it cannot be read, any campaign. */
  campaign: Campaign
  text: string
  readable: boolean
}

interface State extends Version {
  /** What the text still says, until what changes texts has come. */
  behind: Campaign | null
  readable: boolean
  /** Which side was edited last: the other one follows. */
  source: 'form' | 'text'
  edits: number
  history: History
  /** What was last read from the text. */
  read?: unknown
}

const load = () => import('../text')
type Tools = Awaited<ReturnType<typeof load>>

let tools: Tools | null = null

function useTools(): [Tools | null, Error | null] {
  const [found, setFound] = useState(tools)
  const [failed, setFailed] = useState<Error | null>(null)
  useEffect(() => {
    load().then(
      (come) => setFound((tools = come)),
      () => setFailed(new Error('A part of this page could not be loaded: reload the page to continue.')),
    )
  }, [])
  return [found, failed]
}

function useSettled<T>(value: T): T {
  const [settled, setSettled] = useState(value)
  useEffect(() => {
    const timer = setTimeout(() => setSettled(value), PAUSE)
    return () => clearTimeout(timer)
  }, [value])
  return settled
}

type Edited = Version & Pick<State, 'behind' | 'readable' | 'source'>

function edited(before: State, next: Edited, what: string): State {
  const history = next.behind ? before.history : recorded(before.history, before, next, what, Date.now())
  return { ...before, ...next, history, edits: before.edits + 1 }
}

const FORM = { readable: true, source: 'form' } as const

/** The text after an edit of the form: changed in its place, or left behind until that can be done. */
function followed(before: State, campaign: Campaign): Edited {
  const said = before.behind ?? before.campaign
  if (!tools) return { ...FORM, campaign, text: before.text, behind: said }
  return { ...FORM, campaign, text: tools.amended(before.text, tools.changesOf(said, campaign)), behind: null }
}

function takenOut(before: State, list: List | 'objectives', index: number): Edited {
  if (!tools || before.behind) return followed(before, without(before.campaign, list, index))
  const [campaign, changes] = tools.takingOut(before.campaign, list, index)
  return { ...FORM, campaign, text: tools.amended(before.text, changes), behind: null }
}

export function useDraft(first: Beginning): Draft {
  const [state, setState] = useState<State>({ ...first, source: 'text', behind: null, edits: 0, history: NOTHING })
  const [loaded, failed] = useTools()
  const given = state.behind ? state.campaign : state.text
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
  const unread = fresh && checked?.document === null && state.source === 'text' && state.edits > 0
  const { data: schema } = useQuery({ ...schemaQuery, enabled: unread })
  // Adjusted while rendering, so that no picture of the old campaign is shown in between.
  const document = fresh ? checked?.document : null
  if (loaded && state.behind) setState(edited(state, followed(state, state.campaign), ''))
  else if (document && document !== state.read)
    setState({ ...state, campaign: asCampaign(document), readable: true, read: document })
  else if (unread && loaded && schema && state.read !== state.text) {
    const nearly = loaded.formOf(state.text, schema)
    setState({ ...state, campaign: nearly ?? state.campaign, readable: nearly !== null, read: state.text })
  }
  const step = (go: typeof undo) =>
    go(state.history, state.text) === null || state.behind
      ? null
      : () =>
          setState((before) => {
            const [history, version] = go(before.history, before.text) ?? [before.history, before]
            return { ...before, ...version, ...FORM, history, edits: before.edits + 1 }
          })
  return {
    campaign: state.campaign,
    text: state.text,
    readable: state.readable,
    checked,
    checking: !fresh || check.isFetching,
    problems: checked?.problems ?? [],
    trouble: failed ?? check.error,
    edits: state.edits,
    set: (at, value) =>
      setState((before) => edited(before, followed(before, write(before.campaign, at, value)), at.join('.'))),
    remove: (list, index) => setState((before) => edited(before, takenOut(before, list, index), '')),
    setText: (text, how = 'typed') =>
      setState((before) =>
        edited(before, { ...before, text, behind: null, source: 'text' }, how === 'typed' ? 'text' : ''),
      ),
    undo: step(undo),
    redo: step(redo),
    typed: async () => {
      const { amended, changesOf } = await load()
      return state.behind ? amended(state.text, changesOf(state.behind, state.campaign)) : state.text
    },
  }
}
