// A method's marker and name.
import { clsx } from 'clsx'
import { isOpen, OUTLINE, useMethodLook } from './methods'
import { figures } from './styles'
import styles from './ui.module.css'

export function Mark({ method }: { method: string | null }) {
  const { colour, shape } = useMethodLook()(method)
  const stroke = `var(${colour})`
  return (
    <svg className={figures.mk} viewBox="0 0 10 10" aria-hidden="true">
      <path
        d={OUTLINE[shape]}
        fill={isOpen(shape) ? 'none' : stroke}
        stroke={isOpen(shape) ? stroke : 'none'}
        strokeWidth={1.9}
      />
    </svg>
  )
}

export function MethodName({ method, title, short }: { method: string | null; title?: string; short?: boolean }) {
  const look = useMethodLook()(method)
  return (
    <span className={clsx('nw', styles.meth)} title={short ? (title ?? look.title) : undefined}>
      <Mark method={method} />
      {short ? look.short : (title ?? look.title)}
    </span>
  )
}
