// In place of the 3D view, where the processor would draw it: the flights from above, until the view is requested.
import { IconCube } from '@tabler/icons-react'
import { clsx } from 'clsx'
import { hasScenario } from '../../api/campaign'
import { Button } from '../../ui/Button'
import { calledOf } from '../data/chosen'
import type { RunData } from '../data/data'
import { PlanPicture } from './PlanPicture'
import { layout } from '../../ui/styles'
import styles from './flight.module.css'

export function Still({ data, onOpen }: { data: RunData; onOpen: () => void }) {
  const { nominalTrace, findingTrace } = data
  const flight = hasScenario(data.campaign) ? (findingTrace ?? nominalTrace) : undefined
  return (
    <div className={styles.still}>
      {flight && (
        <PlanPicture flight={flight} nominal={nominalTrace} name={findingTrace ? calledOf(data) : 'nominal'} size={[720, 400]} />
      )}
      <div className={clsx('sec', layout.row)}>
        <span>
          {flight && 'Seen from above, around the closest approach. '}
          This browser has no graphics processor: a view in 3D loads the processor while it moves.
        </span>
        <Button icon={IconCube} onClick={onOpen}>Open in 3D</Button>
      </div>
    </div>
  )
}
