// The edited campaign. Its text is authoritative: an edit in the form changes the text in place, and the form shows the
// text as parsed by the service.
import { useDebouncedValue } from '@mantine/hooks'
import { keepPreviousData, replaceEqualDeep, useQuery } from '@tanstack/react-query'
import { useCallback, useEffect, useState } from 'react'
import { checkCampaign } from '../../api/calls'
import { pulse, useContact } from '../../api/pulse'
import { schemaQuery } from '../../api/queries'
import { asCampaign, type Campaign, type List, without, write } from '../../api/campaign'
import type { FieldProblem } from '../../api/problems'
import type { Checked } from '../../client'
import type { FormProps } from '../fields/props'
import { type History, NOTHING, recorded, redo, undo, type Version } from './history'

const PAUSE = 300
const NONE: readonly FieldProblem[] = []

export interface Draft extends Pick<FormProps, 'campaign' | 'set' | 'remove'> {
  text: string
  /** Whether form and text agree; false while the text cannot be parsed as a campaign. */
  readable: boolean
  checked: Checked | undefined
  /** The response below belongs to an earlier state. */
  checking: boolean
  problems: readonly FieldProblem[]
  /** The reason why the check or the change of the text failed. */
  trouble: Error | null
  /** Checks again after a check that failed. */
  recheck: (() => void) | null
  edits: number
  setText: (text: string, how?: 'typed' | 'replaced') => void
  undo: (() => void) | null
  redo: (() => void) | null
  /** The text after all edits are applied. */
  typed: () => Promise<string>
}

/** The initial state of an editor. */
export interface Beginning {
  /** The parsed text, or the form's approximation; any campaign if it cannot be parsed. */
  campaign: Campaign
  text: string
  readable: boolean
}

interface State extends Version {
  /** The previous text, until the text bundle is loaded. */
  behind: Campaign | null
  readable: boolean
  /** The side that was edited last; the other one is updated. */
  source: 'form' | 'text'
  edits: number
  history: History
  /** The last parsed campaign of the text. */
  read?: unknown
}

const load = () => import('../text')
type Tools = Awaited<ReturnType<typeof load>>

let tools: Tools | null = null

function useTools(): [Tools | null, Error | null] {
  const [found, setFound] = useState(tools)
  const [failed, setFailed] = useState<Error | null>(null)
  const well = useContact().state === 'well'
  useEffect(() => {
    if (!well) return // what is edited meanwhile is written into the text afterwards
    load().then(
      (come) => {
        setFound((tools = come))
        setFailed(null)
      },
      () => {
        setFailed(new Error('A part of this page could not be loaded. It is loaded once the service answers; if Clearance was updated, reload the page.'))
        void pulse.check()
      },
    )
  }, [well])
  return [found, failed]
}

type Edited = Version & Pick<State, 'behind' | 'readable' | 'source'>

function edited(before: State, next: Edited, what: string): State {
  const history = next.behind ? before.history : recorded(before.history, before, next, what, Date.now())
  return { ...before, ...next, history, edits: before.edits + 1 }
}

const FORM = { readable: true, source: 'form' } as const

/** The text after an edit of the form: changed in place, or deferred until possible. */
function followed(before: State, campaign: Campaign): Edited {
  const shown = before.behind ?? before.campaign
  if (!tools) return { ...FORM, campaign, text: before.text, behind: shown }
  return { ...FORM, campaign, text: tools.amended(before.text, tools.changesOf(shown, campaign)), behind: null }
}

function takenOut(before: State, list: List | 'objectives', index: number): Edited {
  if (!tools || before.behind) return followed(before, without(before.campaign, list, index))
  const [campaign, changes] = tools.takingOut(before.campaign, list, index)
  return { ...FORM, campaign, text: tools.amended(before.text, changes), behind: null }
}

export function useDraft(first: Beginning): Draft {
  const [state, setState] = useState<State>({ ...first, source: 'text', behind: null, edits: 0, history: NOTHING })
  const [loaded, failed] = useTools()
  const source = state.behind ? state.campaign : state.text
  const [settled] = useDebouncedValue(source, PAUSE)
  const check = useQuery({
    queryKey: ['check', settled],
    queryFn: ({ signal }) => checkCampaign(settled, signal),
    placeholderData: keepPreviousData,
    staleTime: 60_000,
    gcTime: 60_000,
  })
  const fresh = settled === source && !check.isPlaceholderData
  const checked = check.data
  const unread = fresh && checked?.document === null && state.source === 'text' && state.edits > 0
  const { data: schema } = useQuery({ ...schemaQuery, enabled: unread })
  // Adjusted during rendering, so that the old campaign is not shown in between. What the service read as it stands in the
  // form stays the same object, which is not rendered again.
  const document = fresh ? checked?.document : null
  if (loaded && state.behind) setState(edited(state, followed(state, state.campaign), ''))
  else if (document && document !== state.read)
    setState({ ...state, campaign: replaceEqualDeep(state.campaign, asCampaign(document)), readable: true, read: document })
  else if (unread && loaded && schema && state.read !== state.text) {
    const nearly = loaded.formOf(state.text, schema)
    setState({ ...state, campaign: nearly ?? state.campaign, readable: nearly !== null, read: state.text })
  }
  const set = useCallback<Draft['set']>(
    (at, value) => setState((before) => edited(before, followed(before, write(before.campaign, at, value)), at.join('.'))),
    [],
  )
  const remove = useCallback<Draft['remove']>((list, index) => setState((before) => edited(before, takenOut(before, list, index), '')), [])
  const step = (go: typeof undo) =>
    go(state.history, state) === null || state.behind
      ? null
      : () =>
          setState((before) => {
            const [history, version] = go(before.history, before) ?? [before.history, before]
            return { ...before, ...version, ...FORM, source: 'text', history, edits: before.edits + 1 }
          })
  return {
    campaign: state.campaign,
    text: state.text,
    readable: state.readable,
    checked,
    checking: !fresh || check.isFetching,
    problems: checked?.problems.length ? checked.problems : NONE,
    trouble: failed ?? check.error,
    recheck: check.isError && !check.isFetching ? () => void check.refetch() : null,
    edits: state.edits,
    set,
    remove,
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
