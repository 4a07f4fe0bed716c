// A small icon button with an accessible name and a tooltip.
import { clsx } from 'clsx'
import type { IconLink } from '@tabler/icons-react'
import buttons from './buttons.module.css'

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
    <button type="button" className={clsx(buttons.iconbtn, buttons.bd)} data-control aria-label={label} title={title} disabled={off} onClick={act}>
      <Icon className="i s" aria-hidden />
    </button>
  )
}
