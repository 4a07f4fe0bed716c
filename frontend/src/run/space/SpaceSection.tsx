// The place of the parameter space on a page. Its card is loaded after the page; its height is reserved, so that the layout
// does not shift.
import { useQueryClient } from '@tanstack/react-query'
import { useNavigate } from '@tanstack/react-router'
import { useEffect, useState } from 'react'
import { flushSync } from 'react-dom'
import { hasScenario } from '../../api/campaign'
import { evaluationsQuery } from '../../api/queries'
import { later, Part } from '../../page/later'
import { useCalm } from '../../ui/useCalm'
import { useNear } from '../../ui/useNear'
import { usePolling } from '../../ui/usePolling'
import type { RunData } from '../data/data'
import { written } from '../flight/whatif'
import type { WhatIfState } from '../flight/useWhatIf'
import { layout } from '../../ui/styles'
import { useWindowEvent } from '@mantine/hooks'

const SpaceCard = later(() => import('./SpaceCard'), 'SpaceCard')

interface Props {
  data: RunData
  /** The what-if of the page, if its card is shown. */
  whatIf: WhatIfState | null
}

export function SpaceSection({ data, whatIf }: Props) {
  const calm = useCalm()
  const [holder, near] = useNear<HTMLDivElement>()
  const [printed, setPrinted] = useState(false)
  useWindowEvent('beforeprint', () => flushSync(() => setPrinted(true)))
  // Drawing all evaluations takes a fifth of the page's time: only where they are seen. To print them, the code must be there.
  useEffect(() => {
    if (calm) void SpaceCard.preload()
  }, [calm])
  return (
    <div className={layout.c12} id="space" style={{ minHeight: 520 }} ref={holder}>
      {calm && (near || printed) && (
        <Part>
          <SpaceCard data={data} className="" whatIf={whatIf} onPick={whatIf && whatIf.change} />
        </Part>
      )}
    </div>
  )
}

/** How often the evaluations of an active run are read while their drawing has been near the window [ms]. */
const OFTEN = 10_000

/** Of an active run: an evaluation is simulated in the window of the flight. */
export function LiveSpace({ data }: { data: RunData }) {
  const navigate = useNavigate()
  const cache = useQueryClient()
  const [holder, near] = useNear<HTMLDivElement>()
  usePolling(() => cache.invalidateQueries({ queryKey: evaluationsQuery(data.run.id).queryKey }), OFTEN, near)
  const flies = hasScenario(data.campaign)
  return (
    <div className={layout.c12} id="space" style={{ minHeight: 520 }} ref={holder}>
      {near && (
        <Part>
          <SpaceCard
            data={data}
            className=""
            whatIf={null}
            onPick={flies ? (next) => void navigate({ to: '/runs/$id/flight', params: { id: data.run.id }, search: (before) => ({ ...before, ...written(next) }) }) : null}
          />
        </Part>
      )}
    </div>
  )
}
