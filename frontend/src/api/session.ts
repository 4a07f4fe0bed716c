// Whether this browser is signed in; any 401 means that it is not.
import { useSyncExternalStore } from 'react'

let out = false
const listeners = new Set<() => void>()

export function signedOut(): void {
  out = true
  for (const listener of listeners) listener()
}

function subscribe(listener: () => void): () => void {
  listeners.add(listener)
  return () => listeners.delete(listener)
}

export const useSignedOut = (): boolean => useSyncExternalStore(subscribe, () => out)
