// The pages: query cache, router.
import { QueryClientProvider } from '@tanstack/react-query'
import { RouterProvider } from '@tanstack/react-router'
import { StrictMode } from 'react'
import { createRoot } from 'react-dom/client'
import { queryClient } from '../api/queries'
import { loaded } from './first'
import { router } from './router'

export async function show(root: HTMLElement): Promise<void> {
  const begun = location.href
  await Promise.allSettled([loaded(location), router.load()]) // the router shows what it could not load
  // Until the router is drawn it hears of no step back or forward.
  if (location.href !== begun) await router.load()
  createRoot(root).render(
    <StrictMode>
      <QueryClientProvider client={queryClient}>
        <RouterProvider router={router} />
      </QueryClientProvider>
    </StrictMode>,
  )
}
