// A small button of which only a picture is seen; its name is read out, and shown under the pointer.
import type { IconLink } from '@tabler/icons-react'

interface IconButtonProps {
  label: string
  /** What is shown under the pointer, where it says more than the name. */
  title?: string
  icon: typeof IconLink
  off?: boolean
  act: () => void
}

export function IconButton({ label, title = label, icon: Icon, off, act }: IconButtonProps) {
  return (
    <button type="button" className="iconbtn bd" aria-label={label} title={title} disabled={off} onClick={act}>
      <Icon className="i s" aria-hidden />
    </button>
  )
}
