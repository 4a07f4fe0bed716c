// A value outside of React, whose changes the components that read it show; and what the browser stores.
import { useSyncExternalStore } from 'react'

/** What this browser has stored under a name; null without any, or without storage. */
export function stored(name: string): string | null {
  try {
    return localStorage.getItem(name)
  } catch {
    return null
  }
}

/** Without storage the value lasts as long as the page. */
export function store(name: string, value: string): void {
  try {
    localStorage.setItem(name, value)
  } catch {
    // The browser forbids it.
  }
}

interface Store<T> {
  get: () => T
  set: (value: T) => void
  useValue: () => T
}

export function storeOf<T>(first: T): Store<T> {
  let value = first
  const listeners = new Set<() => void>()
  const get = () => value
  const subscribe = (listener: () => void) => {
    listeners.add(listener)
    return () => listeners.delete(listener)
  }
  return {
    get,
    set: (next) => {
      value = next
      for (const listener of listeners) listener()
    },
    useValue: () => useSyncExternalStore(subscribe, get, get),
  }
}
