// Notices over the 3D view: opening, lost and being restored, or failed with advice.
import { IconCheck, IconLoader, IconPlugConnectedX } from '@tabler/icons-react'
import { clsx } from 'clsx'
import type { Known } from './view'
import { Button } from '../../ui/Button'
import { icons, layout } from '../../ui/styles'
import runStyles from '../run.module.css'

export function FlightNotice({ known: { phase, statement }, onRetry }: { known: Known; onRetry: () => void }) {
  return (
    <div className={clsx('sec', runStyles.poster, phase === 'open' && runStyles.back)} role="status">
      {(phase === 'opening' || phase === 'lost') && (
        <span className={layout.row}>
          <IconLoader className={clsx(icons.spin, 'i')} aria-hidden /> {phase === 'lost' ? statement : 'Opening the 3D view'}
        </span>
      )}
      {phase === 'failed' && (
        <span className={runStyles.failed}>
          <IconPlugConnectedX className="i" aria-hidden />
          <span>{statement}</span>
          <Button small onClick={onRetry}>Open the 3D view again</Button>
        </span>
      )}
      {phase === 'open' && statement && (
        <span className={layout.row}>
          <IconCheck className="i s" aria-hidden /> {statement}
        </span>
      )}
    </div>
  )
}

/** Shown in place of the view in a browser that cannot draw it. */
export function NotDrawable({ what, alone }: { what: 'flight' | 'case'; alone: boolean }) {
  return (
    <div className={clsx('sec', runStyles.poster)} role="status">
      <span className={runStyles.failed}>
        <IconPlugConnectedX className="i" aria-hidden />
        <span>
          No 3D view: this browser has no 3D graphics (WebGL 2). Enable them and reload the page. All numbers of the
          {` ${what} `}are {alone ? 'on the page of the run' : 'also on this page'}.
        </span>
      </span>
    </div>
  )
}
