// The place of the parameter space on a page. Its card is loaded after the page; its height is reserved, so that the layout
// does not shift.
import { useQuery, useQueryClient } from '@tanstack/react-query'
import { useNavigate } from '@tanstack/react-router'
import { useWindowEvent } from '@mantine/hooks'
import { type ComponentProps, useCallback, useEffect, useState } from 'react'
import { flushSync } from 'react-dom'
import { hasScenario } from '../../api/campaign'
import { pointsQuery } from '../../api/queries'
import { later, Part } from '../../page/later'
import { Failed } from '../../page/Trouble'
import { Card } from '../../ui/Card'
import { useBeforePrint, useNear } from '../../ui/useNear'
import { usePolling } from '../../ui/usePolling'
import type { RunData } from '../data/data'
import { written } from '../flight/whatif'
import type { WhatIfState } from '../flight/useWhatIf'
import { layout } from '../../ui/styles'

const SpaceCard = later(() => import('./SpaceCard'), 'SpaceCard')

interface Props {
  data: RunData
  /** The what-if of the page, if its card is shown. */
  whatIf: WhatIfState | null
}

/** Reading and drawing all evaluations takes a fifth of the page's time: only where they are seen. */
export function SpaceSection({ data, whatIf }: Props) {
  const [holder, near] = useNear<HTMLDivElement>()
  const printed = usePrinted(data.run)
  return (
    <div className={layout.c12} id="space" style={{ minHeight: 520 }} ref={holder}>
      {(near || printed) && <Space data={data} whatIf={whatIf} onPick={whatIf && whatIf.change} />}
    </div>
  )
}

/** The card, once the evaluations that it draws are there. */
function Space(props: Omit<ComponentProps<typeof SpaceCard>, 'evaluations'>) {
  const { data: evaluations, error, refetch } = useQuery(pointsQuery(props.data.run))
  useEffect(() => void SpaceCard.preload(), [])
  if (evaluations)
    return (
      <Part>
        <SpaceCard {...props} evaluations={evaluations} />
      </Part>
    )
  return (
    <Card title="Parameter space">
      {error ? <Failed error={error} retry={() => void refetch()} /> : <p className="sec">Loading the evaluations …</p>}
    </Card>
  )
}

/** Whether the page is being printed; the evaluations are read before. */
function usePrinted({ id, state }: RunData['run']): boolean {
  const cache = useQueryClient()
  const [printed, setPrinted] = useState(false)
  const prepare = useCallback(() => {
    void SpaceCard.preload()
    void cache.prefetchQuery(pointsQuery({ id, state }))
  }, [cache, id, state])
  useBeforePrint(prepare)
  useWindowEvent('beforeprint', () => flushSync(() => setPrinted(true)))
  return printed
}

/** How often the evaluations of an active run are read while their drawing has been near the window [ms]. */
const OFTEN = 10_000

/** Of an active run: an evaluation is simulated in the window of the flight. */
export function LiveSpace({ data }: { data: RunData }) {
  const navigate = useNavigate()
  const cache = useQueryClient()
  const [holder, near] = useNear<HTMLDivElement>()
  usePolling(() => cache.refetchQueries({ queryKey: pointsQuery(data.run).queryKey }), OFTEN, near)
  const flies = hasScenario(data.campaign)
  return (
    <div className={layout.c12} id="space" style={{ minHeight: 520 }} ref={holder}>
      {near && (
        <Space
          data={data}
          whatIf={null}
          onPick={flies ? (next) => void navigate({ to: '/runs/$id/flight', params: { id: data.run.id }, search: (before) => ({ ...before, ...written(next) }) }) : null}
        />
      )}
    </div>
  )
}
