// The pages: theme, query cache, router.
import { MantineProvider } from '@mantine/core'
import { QueryClientProvider } from '@tanstack/react-query'
import { RouterProvider } from '@tanstack/react-router'
import { StrictMode } from 'react'
import { createRoot } from 'react-dom/client'
import { queryClient } from '../api/queries'
import { useTheme } from '../theme/useTheme'
import { mantineTheme } from './mantine'
import { router } from './router'

function Pages() {
  const theme = useTheme()
  return (
    // Mantine's inline style elements are disabled: its variables come from a file.
    <MantineProvider
      theme={mantineTheme}
      forceColorScheme={theme}
      withCssVariables={false}
      withGlobalClasses={false}
      deduplicateCssVariables={false}
    >
      <QueryClientProvider client={queryClient}>
        <RouterProvider router={router} />
      </QueryClientProvider>
    </MantineProvider>
  )
}

export function show(root: HTMLElement): void {
  createRoot(root).render(
    <StrictMode>
      <Pages />
    </StrictMode>,
  )
}
