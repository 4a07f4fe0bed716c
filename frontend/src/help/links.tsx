// Links from other pages to the help.
import { IconHelp } from '@tabler/icons-react'
import { Link } from '@tanstack/react-router'
import { clsx } from 'clsx'
import styles from './help.module.css'

export const idOfComponent = (role: string, name: string): string => `${role}-${name}`

interface HelpLinkProps {
  to: '/help' | '/help/evidence' | '/help/methods' | '/help/components'
  /** The section of the page. */
  at?: string
  children: string
}

export function HelpLink({ to, at, children }: HelpLinkProps) {
  return (
    <Link to={to} hash={at} className={clsx('small nw', styles.helplink)}>
      <IconHelp className="i s" aria-hidden />
      {children}
    </Link>
  )
}
