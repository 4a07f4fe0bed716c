// Light or dark: the stored choice, else the system's setting, for the page, its widgets and its canvases.
import { useSyncExternalStore } from 'react'

export type Theme = 'light' | 'dark'

const listeners = new Set<() => void>()
const system = matchMedia('(prefers-color-scheme: dark)')

function stored(): Theme | null {
  try {
    const value = localStorage.getItem('theme')
    return value === 'dark' || value === 'light' ? value : null
  } catch {
    return null
  }
}

const current = (): Theme => stored() ?? (system.matches ? 'dark' : 'light')

let shown = current()

function apply(): void {
  shown = current()
  document.documentElement.dataset.theme = shown
  document.documentElement.dataset.mantineColorScheme = shown
  for (const listener of listeners) listener()
}

system.addEventListener('change', apply)
addEventListener('storage', apply)

export function toggleTheme(): void {
  const next: Theme = shown === 'dark' ? 'light' : 'dark'
  try {
    localStorage.setItem('theme', next)
  } catch {
    // Without storage the choice cannot be kept; the system's setting stays.
  }
  apply()
}

function subscribe(listener: () => void): () => void {
  listeners.add(listener)
  return () => listeners.delete(listener)
}

export const useTheme = (): Theme => useSyncExternalStore(subscribe, () => shown)
