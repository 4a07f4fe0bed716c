// Starts the pages: styles, theme, query cache, router.
import '@fontsource-variable/inter/index.css'
import '@fontsource-variable/jetbrains-mono/index.css'
import { MantineProvider } from '@mantine/core'
import { QueryClientProvider } from '@tanstack/react-query'
import { RouterProvider } from '@tanstack/react-router'
import { StrictMode } from 'react'
import { createRoot } from 'react-dom/client'
import { queryClient } from './api/queries'
import { mantineTheme } from './app/mantine'
import './theme/tokens.css'
import './theme/base.css'
import './theme/shell.css'
import './theme/parts.css'
import './theme/pages.css'
import './theme/docs.css'
import './theme/jump.css'
import './theme/mantine.css'
import { router } from './app/router'
import { useTheme } from './theme/useTheme'

function Pages() {
  const theme = useTheme()
  return (
    // Mantine's own style elements are left out: its variables come from a file, so no inline style element is needed.
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

const root = document.getElementById('root')
if (root)
  createRoot(root).render(
    <StrictMode>
      <Pages />
    </StrictMode>,
  )
