// A small icon button with an accessible name and a tooltip.
import { clsx } from 'clsx'
import type { IconLink } from '@tabler/icons-react'
import { buttons } from './styles'

interface IconButtonProps {
  label: string
  /** The tooltip, if it differs from the name. */
  title?: string
  icon: typeof IconLink
  off?: boolean
  act: () => void
  /** Without a border. */
  bare?: boolean
  /** With an icon of full size. */
  large?: boolean
  /** Whether what it shows is open. */
  expanded?: boolean
  /** Whether what it turns on and off is on. */
  pressed?: boolean
  className?: string
}

export function IconButton({ label, title = label, icon: Icon, off, act, bare, large, expanded, pressed, className }: IconButtonProps) {
  return (
    <button
      type="button"
      className={clsx(buttons.iconbtn, !bare && buttons.bd, className)}
      data-control={bare ? undefined : true}
      aria-label={label}
      aria-expanded={expanded}
      aria-pressed={pressed}
      title={title}
      disabled={off}
      onClick={act}
    >
      <Icon className={large ? 'i' : 'i s'} aria-hidden />
    </button>
  )
}
