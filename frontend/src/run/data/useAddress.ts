// Reads and changes what stands in the address of a run's page, without a step in the browser's history.
import { useNavigate, useSearch } from '@tanstack/react-router'
import { useCallback } from 'react'
import type { ChosenSearch } from './chosen'

/** What is asked for, and a way to change a part of it; undefined takes a part out. */
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
