// The draft on the service that an editor belongs to: saved over the version that was opened, and never over another one
// unseen. Start reading at `useSaved`.
import { useMutation, useQueryClient } from '@tanstack/react-query'
import { useState } from 'react'
import { createDraft, deleteDraft, saveDraft } from '../../api/calls'
import { Refusal } from '../../api/problems'
import type { Draft } from '../../client'

export interface Content {
  name: string
  tags: string[]
  text: string
}

export interface Saved {
  draft: Draft | null
  saving: boolean
  trouble: Error | null
  /** Somebody else saved it meanwhile. */
  overtaken: boolean
  /** Saves it: as another draft where that is asked for, without a word to `onSaved` where the page is left. */
  save: (how?: { another?: boolean; leaving?: boolean }) => Promise<Draft>
  /** After a run was started from it: deletes it, or keeps which run that was. */
  launched: (run: string, remove: boolean) => Promise<unknown>
}

/** `content` gives what is to be kept; `onSaved` hears of it. */
export function useSaved(first: Draft | null, content: () => Promise<Content>, onSaved: (draft: Draft) => void): Saved {
  const [draft, setDraft] = useState(first)
  const cache = useQueryClient()
  const saving = useMutation({
    mutationFn: async ({ another }: { another?: boolean; leaving?: boolean }) => {
      const given = await content()
      return draft && !another ? saveDraft(draft.id, { ...given, version: draft.version }) : createDraft(given)
    },
    onSuccess: (kept, { leaving }) => {
      setDraft(kept)
      cache.setQueryData(['draft', kept.id], kept)
      void cache.invalidateQueries({ queryKey: ['drafts'] })
      if (!leaving) onSaved(kept)
    },
  })
  const launched = async (run: string, remove: boolean) => {
    if (!draft) return
    if (remove) await deleteDraft(draft.id, draft.version)
    else await saveDraft(draft.id, { ...(await content()), version: draft.version, run })
    cache.removeQueries({ queryKey: ['draft', draft.id] })
    await cache.invalidateQueries({ queryKey: ['drafts'] })
  }
  return {
    draft,
    saving: saving.isPending,
    trouble: saving.error,
    overtaken: saving.error instanceof Refusal && saving.error.status === 409,
    save: (how = {}) => saving.mutateAsync(how),
    launched,
  }
}
