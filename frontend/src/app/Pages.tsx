// The pages: theme, query cache, router.
import { MantineContext, MantineThemeProvider } from '@mantine/core'
import { QueryClientProvider } from '@tanstack/react-query'
import { RouterProvider } from '@tanstack/react-router'
import { StrictMode, useMemo } from 'react'
import { createRoot } from 'react-dom/client'
import { queryClient } from '../api/queries'
import { useTheme } from '../theme/useTheme'
import { loaded } from './first'
import { mantineTheme } from './mantine'
import { router } from './router'

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

function Pages() {
  const colorScheme = useTheme()
  const context = useMemo(() => ({ ...mantine, colorScheme }), [colorScheme])
  return (
    <MantineContext value={context}>
      <MantineThemeProvider theme={mantineTheme}>
        <QueryClientProvider client={queryClient}>
          <RouterProvider router={router} />
        </QueryClientProvider>
      </MantineThemeProvider>
    </MantineContext>
  )
}

export async function show(root: HTMLElement): Promise<void> {
  const begun = location.href
  await Promise.allSettled([loaded(location), router.load()]) // the router shows what it could not load
  // Until the router is drawn it hears of no step back or forward.
  if (location.href !== begun) await router.load()
  createRoot(root).render(
    <StrictMode>
      <Pages />
    </StrictMode>,
  )
}
