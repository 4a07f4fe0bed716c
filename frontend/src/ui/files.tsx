// Copy to the clipboard, save as a file.
import { IconCheck, IconCopy } from '@tabler/icons-react'
import type { ReactNode } from 'react'
import { Button } from './Button'
import { useBrief } from './useBrief'

/** How long a browser may take to read what it saves: some ask first where to [ms]. */
const READ = 40_000

/** Saves text or a blob as a file. */
export function save(name: string, content: string | Blob, type = 'text/plain'): void {
  const blob = typeof content === 'string' ? new Blob([content], { type: `${type};charset=utf-8` }) : content
  const url = URL.createObjectURL(blob)
  const link = document.createElement('a')
  link.href = url
  link.download = name
  link.click()
  setTimeout(() => URL.revokeObjectURL(url), READ)
}

const LABEL = { copied: 'Copied', refused: 'The browser blocks copying' }

/** Copies a text; whether the browser did. Where a page came by plain HTTP, there is only the older command. */
export async function copied(text: string): Promise<boolean> {
  if ('clipboard' in navigator)
    return navigator.clipboard.writeText(text).then(
      () => true,
      () => false,
    )
  const fill = (event: ClipboardEvent) => {
    event.preventDefault()
    event.clipboardData?.setData('text/plain', text)
  }
  document.addEventListener('copy', fill)
  const done = document.execCommand('copy')
  document.removeEventListener('copy', fill)
  return done
}

/** What a page says where the browser has refused. */
export const byHand = (text: string) => `The browser blocks copying; copy it by hand: ${text}`

/** Copies a text, and tells for a while [ms] whether the browser did. */
export function useCopy(period: number) {
  const [outcome, setOutcome] = useBrief<'copied' | 'refused'>(period)
  const copy = async (text: string) => setOutcome((await copied(text)) ? 'copied' : 'refused')
  return { outcome, copy }
}

/** A button that copies and confirms it. */
export function CopyButton({ text, children }: { text: () => string; children: ReactNode }) {
  const { outcome, copy } = useCopy(1600)
  return (
    <Button small icon={outcome === 'copied' ? IconCheck : IconCopy} onClick={() => void copy(text())}>
      <span aria-live="polite">{outcome ? LABEL[outcome] : children}</span>
    </Button>
  )
}
