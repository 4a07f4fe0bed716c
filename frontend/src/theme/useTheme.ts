// Light or dark: the stored choice, else the system's setting, for the page, its widgets and its canvases.
import { store, stored, storeOf } from '../ui/store'

export type Theme = 'light' | 'dark'

const system = matchMedia('(prefers-color-scheme: dark)')

function current(): Theme {
  const chosen = stored('theme')
  return chosen === 'dark' || chosen === 'light' ? chosen : system.matches ? 'dark' : 'light'
}

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
  store('theme', shown.get() === 'dark' ? 'light' : 'dark')
  apply()
}

export const useTheme = shown.useValue
