// Copy to the clipboard, save as a file.
import { useClipboard } from '@mantine/hooks'
import { IconCheck, IconCopy } from '@tabler/icons-react'
import type { ReactNode } from 'react'
import { Button } from './Button'

/** Saves text or a blob as a file. */
export function save(name: string, content: string | Blob, type = 'text/plain'): void {
  const blob = typeof content === 'string' ? new Blob([content], { type: `${type};charset=utf-8` }) : content
  const url = URL.createObjectURL(blob)
  const link = document.createElement('a')
  link.href = url
  link.download = name
  link.click()
  URL.revokeObjectURL(url)
}

interface CopyProps {
  text: () => string
  children: ReactNode
}

/** A button that copies and confirms it. */
export function CopyButton({ text, children }: CopyProps) {
  const { copied: done, copy } = useClipboard({ timeout: 1600 })
  return (
    <Button small icon={done ? IconCheck : IconCopy} onClick={() => copy(text())}>
      <span aria-live="polite">{done ? 'Copied' : children}</span>
    </Button>
  )
}
