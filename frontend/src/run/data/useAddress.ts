// Reads and changes the address of a run's page, without a new entry in the browser's history.
import { useNavigate, useSearch } from '@tanstack/react-router'
import { useCallback } from 'react'
import type { ChosenSearch } from './chosen'

/** The state of the address and a setter; undefined removes a key. */
export function useAddress(id: string): [ChosenSearch, (change: Partial<ChosenSearch>) => void] {
  const navigate = useNavigate()
  const search = useSearch({ from: '/runs/$id' })
  const change = useCallback(
    (part: Partial<ChosenSearch>) =>
      void navigate({
        to: '.',
        params: { id },
        search: (before) => ({ ...before, ...part }),
        hash: (hash) => hash ?? '',
        replace: true,
        resetScroll: false,
        hashScrollIntoView: false,
      }),
    [navigate, id],
  )
  return [search, change]
}
