// Below the result of a what-if of a simulator: when it is evaluated, how long that takes, and what the result is.
import { IconPlayerPlay } from '@tabler/icons-react'
import { useQuery } from '@tanstack/react-query'
import { useId } from 'react'
import { caseInstalledQuery } from '../../api/queries'
import type { CaseAnswer, FlightAnswer } from '../../client'
import { plain } from '../../format/numbers'
import type { WhatIfState } from './useWhatIf'
import { Button } from '../../ui/Button'
import styles from './flight.module.css'

/** A time as "about 4 s": two digits are enough to decide whether to wait. */
export const aboutOf = (seconds: number): string =>
  seconds < 0.001 ? 'less than 0.001 s' : `about ${plain(Number(seconds.toPrecision(seconds < 10 ? 1 : 2)))} s`

const isCase = (answer: FlightAnswer | CaseAnswer | null): answer is CaseAnswer => answer !== null && 'seconds' in answer

type Props = Pick<WhatIfState, 'answer' | 'busy' | 'follows' | 'stale' | 'seconds' | 'evaluate'>

/** Reports before the first evaluation that the machine of the service lacks the simulator. */
export function InstalledNote({ run, ...state }: Props & { run: string }) {
  const { data } = useQuery(caseInstalledQuery(run))
  return <CaseNote {...state} missing={data?.reason ?? ''} />
}

interface NoteProps extends Props {
  /** Why no case can be evaluated; empty if it can, or while that is not known. */
  missing?: string
}

export function CaseNote({ answer, busy, follows, stale, seconds, evaluate, missing = '' }: NoteProps) {
  const why = useId()
  return (
    <div className={styles.caseNote}>
      {follows && seconds !== null ? (
        <p className="small sec">Evaluated as the values change: an evaluation takes {aboutOf(seconds)}.</p>
      ) : (
        <Button small icon={IconPlayerPlay} disabled={busy || missing !== ''} aria-describedby={missing ? why : undefined} onClick={evaluate}>
          {busy ? 'Evaluating …' : `Evaluate${seconds === null ? '' : ` (${aboutOf(seconds)})`}`}
        </Button>
      )}
      {missing && (
        <p className="small sec" id={why}>
          No case can be evaluated: {missing}.
        </p>
      )}
      {answer && stale && !follows && !busy && (
        <p className="small sec">The result belongs to other values: evaluate to update it.</p>
      )}
      {isCase(answer) && answer.untraced && <p className="small sec">No trace of it: {answer.untraced}.</p>}
      <p className="small mut">One call on the machine of the service. It is not stored and is no evidence.</p>
    </div>
  )
}
