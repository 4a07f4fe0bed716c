// The mark: a dashed safety circle and the path that clears it.
import { Link } from '@tanstack/react-router'
import { clsx } from 'clsx'
import { layout } from '../ui/styles'
import styles from './app.module.css'

export function BrandMark() {
  return (
    <svg viewBox="0 0 24 24" width={22} height={22} fill="none" aria-hidden="true">
      <circle cx="13.5" cy="10.5" r="6.2" stroke="currentColor" strokeWidth="1.6" strokeDasharray="2.6 2.1" />
      <circle cx="13.5" cy="10.5" r="2.1" fill="currentColor" />
      <path d="M2 20.5c6 .6 14.5-.2 19.5-5.5" stroke="var(--c-worst)" strokeWidth="2" strokeLinecap="round" />
    </svg>
  )
}

export function Brand() {
  return (
    <Link to="/runs" className={clsx(layout.row, 'b', styles.brand)} aria-label="Clearance">
      <BrandMark />
      <span>Clearance</span>
    </Link>
  )
}
