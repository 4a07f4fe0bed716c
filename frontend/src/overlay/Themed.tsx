// What parts of Mantine need around them.
import { MantineContext, MantineThemeProvider } from '@mantine/core'
import { type ReactNode, useMemo } from 'react'
import { useTheme } from '../theme/useTheme'
import { mantineTheme } from './theme'

// Not by MantineProvider, whose module computes 300 CSS variables: they come from a file, and the document's theme is set by
// theme/useTheme.ts.
const ignored = () => undefined
const mantine = {
  setColorScheme: ignored,
  clearColorScheme: ignored,
  getRootElement: () => document.documentElement,
  classNamesPrefix: 'mantine',
  cssVariablesSelector: ':root',
  withStaticClasses: true,
}

export function Themed({ children }: { children: ReactNode }) {
  const colorScheme = useTheme()
  const context = useMemo(() => ({ ...mantine, colorScheme }), [colorScheme])
  return (
    <MantineContext value={context}>
      <MantineThemeProvider theme={mantineTheme}>{children}</MantineThemeProvider>
    </MantineContext>
  )
}
