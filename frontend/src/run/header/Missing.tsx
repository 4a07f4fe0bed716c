// Above the results of a run: the parts that could not be loaded, so that their absence is not read as "there are none".
import { IconAlertTriangle } from '@tabler/icons-react'
import { clsx } from 'clsx'
import { listed, type MissingPart } from '../data/missing'
import { Button } from '../../ui/Button'
import { cards, layout } from '../../ui/styles'

export function Missing({ parts }: { parts: readonly MissingPart[] }) {
  if (parts.length === 0) return null
  const reasons = [...new Set(parts.map(({ error }) => error.message.replace(/[.\s]+$/, '')))]
  return (
    <div className={clsx(cards.note, cards.bad)} role="alert" style={{ marginBottom: 'var(--gap)', alignItems: 'center' }}>
      <IconAlertTriangle className="i" aria-hidden />
      <span className={layout.wrapAny}>
        <b>This page is incomplete:</b> {listed(parts)} could not be loaded. {reasons.map((reason) => `${reason.charAt(0).toUpperCase()}${reason.slice(1)}.`).join(' ')}
      </span>
      <Button small className={layout.atend} onClick={() => parts.forEach(({ retry }) => retry())}>Try again</Button>
    </div>
  )
}
