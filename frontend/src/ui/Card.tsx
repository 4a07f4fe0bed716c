// A card with its heading, and small elements of cards.
import { clsx } from 'clsx'
import { type ReactNode, type Ref, useEffect, useRef, useState } from 'react'
import { field } from '../format/numbers'
import { badges, buttons, cards, layout, tables } from './styles'
import styles from './ui.module.css'

export interface CardProps {
  /** Without one the card has no header. */
  title?: ReactNode
  note?: ReactNode
  right?: ReactNode
  footer?: ReactNode
  flush?: boolean
  /** Whether it is in a section that has a heading of its own. */
  inner?: boolean
  className?: string
  id?: string
  ref?: Ref<HTMLElement>
  children: ReactNode
}

export function Card({ title, note, right, footer, flush, inner, className, id, ref, children }: CardProps) {
  const Heading = inner ? 'h3' : 'h2'
  return (
    <section className={clsx(cards.card, className)} id={id} ref={ref}>
      {title !== undefined && (
        <div className={cards.h}>
          <Heading>{title}</Heading>
          <span className={clsx('mut small', cards.d)}>{note}</span>
          {right && <div className={clsx(layout.row, layout.atend, cards.r)}>{right}</div>}
        </div>
      )}
      {flush ? <Flush>{children}</Flush> : <div className={cards.bd} data-body>{children}</div>}
      {footer && <div className={clsx('mut small', styles.ft)}>{footer}</div>}
    </section>
  )
}

/** A body without padding; wide content scrolls, also by keyboard. */
function Flush({ children }: { children: ReactNode }) {
  const body = useRef<HTMLDivElement>(null)
  const [scrolls, setScrolls] = useState(false)
  useEffect(() => {
    const element = body.current
    if (!element) return
    const observer = new ResizeObserver(() => setScrolls(element.scrollWidth > element.clientWidth + 1))
    observer.observe(element)
    return () => observer.disconnect()
  }, [])
  return (
    <div data-flush data-body className={clsx(cards.bd, styles.flush)} ref={body} tabIndex={scrolls ? 0 : undefined}>
      {children}
    </div>
  )
}

interface StatProps {
  name: ReactNode
  value: ReactNode
  unit?: ReactNode
  note?: ReactNode
  bad?: boolean
  testId?: string
  /** The value with all digits, shown on hover. */
  exact?: number | null
}

export function Stat({ name, value, unit, note, bad, testId, exact }: StatProps) {
  return (
    <div className={styles.stat}>
      <div className={clsx('mut nw', styles.k)}>{name}</div>
      <div className={clsx('b nw tn', styles.n, bad && 'bad-t')}>
        <span data-testid={testId} title={exact == null ? undefined : field(exact)}>
          {value}
        </span>
        {unit && <small>{unit}</small>}
      </div>
      <div className={clsx('mut', styles.x)}>{note}</div>
    </div>
  )
}

interface NumHeadProps {
  unit: ReactNode
  title?: string
  className?: string
  children: ReactNode
}

/** The header of a numeric column: title, and below it the unit. */
export function NumHead({ unit, title, className, children }: NumHeadProps) {
  return (
    <th className={clsx('num', className)} title={title}>
      {children}
      <br />
      <span className={tables.u}>{unit}</span>
    </th>
  )
}

export interface SegProps<T extends string> {
  label: string
  /** The words for each value. */
  options: Readonly<Partial<Record<T, ReactNode>>>
  value: T
  onChange: (value: T) => void
  tall?: boolean
}

export function Seg<T extends string>({ label, options, value, onChange, tall }: SegProps<T>) {
  return (
    <div className={tall ? clsx(buttons.seg, styles.tall) : buttons.seg} role="group" aria-label={label}>
      {(Object.keys(options) as T[]).map((option) => (
        <button key={option} type="button" aria-pressed={option === value} onClick={() => onChange(option)}>
          {options[option]}
        </button>
      ))}
    </div>
  )
}

export function Progress({ share, colour, label }: { share: number; colour?: string; label?: string }) {
  const width = Math.min(100, Math.max(0, share * 100))
  return (
    <div
      className={styles.pbar}
      role="progressbar"
      aria-label={label ?? 'Progress'}
      aria-valuemin={0}
      aria-valuemax={100}
      aria-valuenow={Math.round(width)}
    >
      <i style={{ width: `${width}%`, background: colour }} />
    </div>
  )
}

export function Tags({ tags }: { tags: readonly string[] }) {
  return (
    <span className="nw">
      {tags.map((tag) => (
        <span key={tag} className={badges.tag}>
          {tag}
        </span>
      ))}
    </span>
  )
}
