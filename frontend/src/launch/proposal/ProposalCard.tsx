// Methods and budgets that fit a length of time, from what an evaluation of the simulator took in an earlier run.
import { keepPreviousData, useQuery } from '@tanstack/react-query'
import { clsx } from 'clsx'
import { useState } from 'react'
import { proposeSearches } from '../../api/calls'
import { thinned } from '../../format/numbers'
import { Button } from '../../ui/Button'
import { Card } from '../../ui/Card'
import type { FormProps } from '../fields/props'
import { requestOf, minutesOf, searchesOf, stated } from './proposal'
import { fields, layout } from '../../ui/styles'
import styles from './proposal.module.css'

const TIME = 'proposal-time'

export function ProposalCard({ campaign, catalogue, set }: FormProps) {
  const [text, setText] = useState('60')
  const minutes = minutesOf(text)
  const request = requestOf(campaign, minutes)
  const { data, error, isPlaceholderData } = useQuery({
    queryKey: ['proposal', request],
    queryFn: () => (request ? proposeSearches(request) : Promise.reject(new Error('there is no request'))),
    enabled: request !== null,
    placeholderData: keepPreviousData,
  })
  const searches = data && request && !isPlaceholderData ? searchesOf(data, catalogue) : []
  const same = searches.length > 0 && stated(campaign, searches)
  const use = () => set(['stages', 'search'], searches)
  return (
    <Card title="Proposal" note="Methods and budgets for the time that you allow the searches." id="section-proposal">
      <p>{thinned(known(request !== null, data?.known, error))}</p>
      {data?.measured && (
        <>
          <div className={clsx(layout.row, styles.time)}>
            <label className={fields.lbl} htmlFor={TIME}>
              Time for all searches
            </label>
            <span className={fields.inp}>
              <input
                id={TIME}
                inputMode="decimal"
                autoComplete="off"
                aria-invalid={minutes === null}
                value={text}
                onChange={(event) => setText(event.target.value)}
              />
              <span className={fields.un}>min</span>
            </span>
            <Button disabled={searches.length === 0 || same} onClick={use}>
              Use the proposal
            </Button>
          </div>
          <p aria-live="polite">{thinned(described(minutes, data.sentence, same))}</p>
          <p className="small mut">The other stages take evaluations in addition, mostly Validate: see Evaluations at most.</p>
        </>
      )}
    </Card>
  )
}

function known(complete: boolean, sentence: string | undefined, error: Error | null): string {
  if (sentence) return sentence
  if (error) return `There is no proposal: ${error.message}`
  return complete ? 'Looking up what an evaluation takes …' : 'A proposal needs a simulator and at least one uncertain parameter.'
}

function described(minutes: number | null, sentence: string, same: boolean): string {
  if (minutes === null) return 'Give the time as a number above 0, at most a year.'
  return same ? `${sentence} The campaign states these searches.` : sentence
}
