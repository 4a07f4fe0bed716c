// Labels of the run, and the run with which it is compared.
import { TagsInput } from '../../overlay/fields'
import { useQuery } from '@tanstack/react-query'
import { clsx } from 'clsx'
import { IconAlertCircle } from '@tabler/icons-react'
import { facetsQuery } from '../../api/queries'
import { Fold } from '../fields/Fold'
import { FieldErrors, idOf } from '../fields/problems'
import type { Regression } from './regression'
import { fields } from '../../ui/styles'
import styles from './regression.module.css'

export function RegressionFields({ regression }: { regression: Regression }) {
  const { labels, baseline, problem, setLabels, setBaseline } = regression
  const { data: facets } = useQuery(facetsQuery)
  const known = facets?.labels.map(({ value }) => value) ?? []
  const digest = [...labels, baseline.trim() && `baseline ${baseline.trim()}`].filter(Boolean).join(', ')
  return (
    <Fold title="Labels and baseline" digest={digest || 'none'} fields={['labels', 'baseline']}>
      <div>
        <TagsInput
          id={idOf('labels')}
          label="Labels"
          value={labels}
          splitChars={[]}
          placeholder={labels.length === 0 ? 'branch=main' : undefined}
          aria-describedby="labels-problem"
          error={problem.labels !== ''}
          onChange={setLabels}
        />
        <Problem id="labels-problem" statement={problem.labels} />
        <FieldErrors field="labels" deep />
      </div>
      <div className={styles.next}>
        <label className={fields.lbl} htmlFor={idOf('baseline')}>
          Baseline
        </label>
        <span className={fields.inp}>
          <input
            id={idOf('baseline')}
            autoComplete="off"
            spellCheck={false}
            maxLength={300}
            list="baselines"
            placeholder="R-0001 or label:branch=main"
            aria-describedby="baseline-problem"
            aria-invalid={problem.baseline !== ''}
            value={baseline}
            onChange={(event) => setBaseline(event.target.value)}
          />
        </span>
        <datalist id="baselines">
          {known.map((label) => (
            <option key={label} value={`label:${label}`}>
              the newest run with this label
            </option>
          ))}
        </datalist>
        <Problem id="baseline-problem" statement={problem.baseline} />
        <FieldErrors field="baseline" />
        <p className={clsx('small mut', styles.next)}>
          The new run evaluates the findings of its baseline first and states what has changed. A draft stores neither labels
          nor baseline.
        </p>
      </div>
    </Fold>
  )
}

function Problem({ id, statement }: { id: string; statement: string }) {
  return (
    <p id={id} className={statement ? fields.ferr : undefined} aria-live="polite">
      {statement && <IconAlertCircle className="i" aria-hidden />}
      {statement && <span>{statement}</span>}
    </p>
  )
}
