// A small icon button with an accessible name and a tooltip.
import type { IconLink } from '@tabler/icons-react'

interface IconButtonProps {
  label: string
  /** The tooltip, if it differs from the name. */
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
