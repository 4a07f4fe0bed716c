// Correlations of uncertain parameters in random samples, as pairs.
import { IconPlus } from '@tabler/icons-react'
import type { Correlation } from '../../api/campaign'
import { Button } from '../../ui/Button'
import { Choice, RemoveButton } from '../fields/Field'
import { Fold } from '../fields/Fold'
import { NumberCell } from '../fields/NumberCell'
import type { FormProps } from '../fields/props'
import { FieldErrors, idOf } from '../fields/problems'
import { layout } from '../../ui/styles'
import styles from './form.module.css'

export function Correlations({ campaign, parameters, set }: FormProps) {
  const pairs = campaign.correlations ?? []
  const paths = Object.keys(campaign.uncertain)
  const replace = (next: Correlation[]) => set(['correlations'], next)
  const label = (path: string) => {
    const found = parameters.find((parameter) => parameter.path === path)
    return found ? `${found.entry.text} (${path})` : path
  }
  const add = () => {
    const taken = (a: string, b: string) => pairs.some(({ between }) => between.includes(a) && between.includes(b))
    const free = paths.flatMap((a, i) => paths.slice(i + 1).map((b) => [a, b] as const)).find(([a, b]) => !taken(a, b))
    replace([...pairs, { between: free ? [...free] : [paths[0] ?? '', paths[1] ?? ''], value: 0.5 }])
  }
  const digest = pairs.length === 0 ? 'none' : pairs.length === 1 ? 'one pair' : `${pairs.length} pairs`
  return (
    <Fold title="Correlations" digest={digest} fields={['correlations']}>
      <div className={styles.correlations} id={idOf('correlations')} tabIndex={-1}>
        <FieldErrors field="correlations" />
        {pairs.map((pair, i) => (
          <div key={i} className={layout.row} id={idOf(`correlations.${i}`)} tabIndex={-1}>
            {[0, 1].map((side) => (
              <Choice
                key={side}
                aria-label={`Pair ${i + 1}, ${side === 0 ? 'one' : 'other'} parameter`}
                w={250}
                data={[...new Set([...paths, ...pair.between])].map((path) => ({ value: path, label: label(path) }))}
                value={pair.between[side] ?? null}
                onChange={(path) => set(['correlations', i, 'between', side], path)}
              />
            ))}
            <span style={{ width: 90 }}>
              <NumberCell
                field={`correlations.${i}.value`}
                label={`Pair ${i + 1}, correlation`}
                value={pair.value}
                onChange={(value) => set(['correlations', i, 'value'], value ?? '')}
              />
            </span>
            <RemoveButton label={`Remove pair ${i + 1}`} onClick={() => replace(pairs.filter((_, j) => j !== i))} />
            <FieldErrors field={`correlations.${i}`} deep />
          </div>
        ))}
        <Button small icon={IconPlus} disabled={paths.length < 2} onClick={add}>
          Add pair
        </Button>
        <p className="small mut">Of random samples only; between two normal distributions it is their correlation, -1 to 1.</p>
      </div>
    </Fold>
  )
}
