// A button with words, and an icon before them. What bars the user from it is its tooltip. And links that look like one,
// buttons that look like a link, and the chips of filters.
import type { IconLink } from '@tabler/icons-react'
import { createLink } from '@tanstack/react-router'
import { clsx } from 'clsx'
import type { AnchorHTMLAttributes, ButtonHTMLAttributes, ReactNode, Ref } from 'react'
import { count } from '../format/numbers'
import { buttons } from './styles'

interface ButtonProps extends ButtonHTMLAttributes<HTMLButtonElement> {
  icon?: typeof IconLink
  small?: boolean
  /** The main action of its place. */
  main?: boolean
  danger?: boolean
  /** As wide as its place, and higher. */
  wide?: boolean
  /** Why this user may not press it. */
  barred?: string | undefined
}

export function Button({ icon: Icon, small, main, danger, wide, barred, disabled, title, className, type = 'button', children, ...rest }: ButtonProps) {
  return (
    <button
      {...rest}
      type={type}
      className={clsx(buttons.btn, small && buttons.s, danger && buttons.danger, main && buttons.p, wide && buttons.wide, className)}
      disabled={disabled || barred !== undefined}
      title={barred ?? title}
    >
      {Icon && <Icon className="i s" aria-hidden />}
      {children}
    </button>
  )
}

interface AnchorProps extends AnchorHTMLAttributes<HTMLAnchorElement>, Pick<ButtonProps, 'icon' | 'small' | 'main'> {
  ref?: Ref<HTMLAnchorElement>
}

/** A link that looks like a button, to a file or out of the pages. */
export const ButtonAnchor = ({ icon: Icon, small, main, className, children, ...rest }: AnchorProps) => (
  <a {...rest} className={clsx(buttons.btn, small && buttons.s, main && buttons.p, className)}>
    {Icon && <Icon className="i s" aria-hidden />}
    {children}
  </a>
)

/** The same, to a page. */
export const ButtonLink = createLink(ButtonAnchor)

/** The looks of a {@link Button}, for the button of a popup. */
export const worded = (Icon: typeof IconLink, words: string, small?: boolean) => ({
  className: clsx(buttons.btn, small && buttons.s),
  children: [<Icon key="icon" className="i s" aria-hidden />, words],
})

/** A button that looks like a link. */
export const TextButton = ({ className, ...rest }: ButtonHTMLAttributes<HTMLButtonElement>) => (
  <button type="button" className={clsx(buttons.linkbtn, className)} {...rest} />
)

/** A filter that is on or off. */
export const Chip = ({ on, act, children }: { on: boolean; act: () => void; children: ReactNode }) => (
  <button type="button" className={clsx('m nw', buttons.chip)} aria-pressed={on} onClick={act}>
    {children}
  </button>
)

/** How many it stands for, in a chip. */
export const ChipCount = ({ of }: { of: number | undefined }) => <span className={buttons.n}>{count(of)}</span>
