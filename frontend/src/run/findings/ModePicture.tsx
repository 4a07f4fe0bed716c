// A thumbnail of a finding: its plan view, loaded near the window or for a print.
import { useQuery } from '@tanstack/react-query'
import { sketchQuery } from '../../api/queries'
import { useNearOrPrint } from '../../ui/useNear'
import { aboveOf } from '../flight/flown'
import { PlanPicture } from '../flight/PlanPicture'
import styles from './findings.module.css'

const [WIDTH, HEIGHT] = [132, 76]

interface ModePictureProps {
  run: string
  /** A finding's label, or `nominal` for only that flight. */
  name: string
  stored: boolean
}

export function ModePicture({ run, name, stored }: ModePictureProps) {
  const [holder, near] = useNearOrPrint<HTMLDivElement>()
  const nominal = useQuery({ ...sketchQuery(run, 'nominal'), enabled: near && stored }).data
  const flight = useQuery({ ...sketchQuery(run, name), enabled: near && stored }).data
  const above = flight ? aboveOf(flight) : null
  return (
    <div ref={holder} className={styles.mode} style={{ width: WIDTH, height: HEIGHT + (above ? 18 : 0) }}>
      {flight && (
        <>
          <PlanPicture flight={flight} nominal={nominal} name={name} size={[WIDTH, HEIGHT]} />
          {above && <span className="sec small">{above}</span>}
        </>
      )}
    </div>
  )
}
