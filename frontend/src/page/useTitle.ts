// The title of the browser's tab.
import { useLayoutEffect } from 'react'

export const useTitle = (title: string): void =>
  useLayoutEffect(() => {
    document.title = `${title} · Clearance`
  }, [title])
