// The title of the browser's tab.
import { useDocumentTitle } from '@mantine/hooks'

export const useTitle = (title: string): void => useDocumentTitle(`${title} · Clearance`)
