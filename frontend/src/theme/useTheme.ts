// Light or dark: the stored choice, else the system's setting, for the page, its widgets and its canvases.
import { storeOf } from '../ui/store'

export type Theme = 'light' | 'dark'

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

const shown = storeOf(current())

function apply(): void {
  const theme = current()
  document.documentElement.dataset.theme = theme
  document.documentElement.dataset.mantineColorScheme = theme
  shown.set(theme)
}

system.addEventListener('change', apply)
addEventListener('storage', apply)

export function toggleTheme(): void {
  const next: Theme = shown.get() === 'dark' ? 'light' : 'dark'
  try {
    localStorage.setItem('theme', next)
  } catch {
    // Without storage the choice cannot be kept; the system's setting stays.
  }
  apply()
}

export const useTheme = shown.useValue
