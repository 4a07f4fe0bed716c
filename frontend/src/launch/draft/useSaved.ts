// The draft of an editor on the service: saved over the version that was opened, never over a newer one.
import { useMutation, useQueryClient } from '@tanstack/react-query'
import { useState } from 'react'
import { createDraft, deleteDraft, saveDraft } from '../../api/calls'
import { useBarred, useBarredFromOwn } from '../../api/may'
import { Refusal } from '../../api/problems'
import type { Draft, DraftContent } from '../../client'

export interface Saved {
  draft: Draft | null
  /** Whether it belongs to another user: saving makes a new draft, and a started run leaves it as it is. */
  foreign: boolean
  saving: boolean
  trouble: Error | null
  /** Another user has saved or deleted it in the meantime, or it is another user's: it can be kept as a new draft. */
  overtaken: boolean
  /** It was deleted: saving makes a new draft. */
  gone: boolean
  /** Saves it, optionally as a new draft; does not call `onSaved` if the page is left. */
  save: (how?: { another?: boolean; leaving?: boolean }) => Promise<Draft>
  /** After a run was started from it: deletes it, or stores the run's number. */
  launched: (run: string, remove: boolean) => Promise<unknown>
}

const refusedWith = (error: unknown, ...statuses: number[]) => error instanceof Refusal && statuses.includes(error.status)

/** `content` returns the content to be saved; `onSaved` is called afterwards. */
export function useSaved(first: Draft | null, content: () => Promise<DraftContent>, onSaved: (draft: Draft) => void): Saved {
  const [draft, setDraft] = useState(first)
  const [gone, setGone] = useState(false)
  const cache = useQueryClient()
  const low = useBarred('engineer')
  const barred = useBarredFromOwn('engineer', ...(draft ? [draft] : []))
  const foreign = low === undefined && barred !== undefined
  const saving = useMutation({
    mutationFn: async ({ another }: { another?: boolean; leaving?: boolean }) => {
      const body = await content()
      if (!draft || another || foreign || gone) return createDraft(body)
      return saveDraft(draft.id, { ...body, version: draft.version }).catch((error: unknown) => {
        setGone(refusedWith(error, 404))
        throw error
      })
    },
    onSuccess: (kept, { leaving }) => {
      setDraft(kept)
      setGone(false)
      cache.setQueryData(['draft', kept.id], kept)
      void cache.invalidateQueries({ queryKey: ['drafts'] })
      if (!leaving) onSaved(kept)
    },
  })
  const launched = async (run: string, remove: boolean) => {
    if (!draft || foreign) return
    if (remove) await deleteDraft(draft.id, draft.version)
    else await saveDraft(draft.id, { ...(await content()), version: draft.version, run })
    cache.removeQueries({ queryKey: ['draft', draft.id] })
    await cache.invalidateQueries({ queryKey: ['drafts'] })
  }
  return {
    draft,
    foreign,
    saving: saving.isPending,
    trouble: saving.error,
    overtaken: (saving.isError && gone) || refusedWith(saving.error, 403, 409),
    gone,
    save: (how = {}) => saving.mutateAsync(how),
    launched,
  }
}
