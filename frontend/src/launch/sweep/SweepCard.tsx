// Launches a sweep: the campaign with several values of one fixed parameter, as one launch.
import { clsx } from 'clsx'
import { IconPlayerTrackNext } from '@tabler/icons-react'
import { useMutation } from '@tanstack/react-query'
import { useState } from 'react'
import { checkCampaign, submitSweep } from '../../api/calls'
import { asCampaign, type Campaign } from '../../api/campaign'
import { useKey } from '../../api/keys'
import { Refusal } from '../../api/problems'
import { unitText } from '../../format/units'
import { Button } from '../../ui/Button'
import { Card } from '../../ui/Card'
import type { Parameter } from '../campaign/parameters'
import { valuesOf } from './values'
import { fields, layout } from '../../ui/styles'

interface SweepCardProps {
  campaign: Campaign
  parameters: readonly Parameter[]
  name: string
  tags: string[]
  labels: Record<string, string>
  /** The campaign cannot be started as it is. */
  blocked: boolean
  typed: () => Promise<string>
  onLaunched: (sweep: string) => void
}

export function SweepCard({ campaign, parameters, name, tags, labels, blocked, typed, onLaunched }: SweepCardProps) {
  const [open, setOpen] = useState(false)
  const [path, setPath] = useState('')
  const [text, setText] = useState('')
  const fixed = parameters.filter((parameter) => !(parameter.path in campaign.uncertain))
  const chosen = fixed.find((parameter) => parameter.path === path) ?? fixed[0]
  const entered = valuesOf(text, chosen?.entry)
  const values = 'values' in entered ? entered.values : null
  const keyOf = useKey()
  const launch = useMutation({
    mutationFn: async () => {
      const checked = await checkCampaign(await typed())
      if (!checked.ok) throw new Refusal(422, 'The campaign has problems', 'Solve the problems of the campaign first.', [])
      const request = { campaign: asCampaign(checked.document), path: chosen?.path ?? '', values: values ?? [], name, tags, labels }
      return submitSweep(request, keyOf(request))
    },
    onSuccess: (sweep) => onLaunched(sweep.id),
  })
  const unit = unitText(chosen?.entry.unit ?? '')
  return (
    <Card
      title="Sweep"
      note="Several values of one parameter"
      id="sweep"
      right={
        <Button small aria-expanded={open} onClick={() => setOpen(!open)}>
          {open ? 'Hide' : 'Show'}
        </Button>
      }
    >
      {!open && <p className="small mut">One run for each value of a parameter that is not uncertain, shown together.</p>}
      {open && fixed.length === 0 && <p className="sec">Every parameter of this campaign is uncertain.</p>}
      {open && fixed.length > 0 && (
        <div className={layout.stack} style={{ gap: 10 }}>
          <div>
            <label className={fields.lbl} htmlFor="sweep-path">
              Parameter
            </label>
            <span className={fields.inp}>
              <select className={fields.select} id="sweep-path" value={chosen?.path} onChange={(event) => setPath(event.target.value)} style={{ flex: 1, minWidth: 0 }}>
                {fixed.map((parameter) => (
                  <option key={parameter.path} value={parameter.path}>
                    {parameter.path}
                  </option>
                ))}
              </select>
            </span>
            {chosen && (
              <p className="small mut">
                {chosen.entry.text}
                {chosen.nominal !== null && `; ${chosen.nominal} ${unit} in the campaign`}
              </p>
            )}
          </div>
          <div>
            <label className={fields.lbl} htmlFor="sweep-values">
              Values{unit && `, ${unit}`}
            </label>
            <span className={'problem' in entered && entered.problem ? clsx(fields.inp, fields.invalid) : fields.inp}>
              <input
                id="sweep-values"
                autoComplete="off"
                placeholder="0.5, 1, 2"
                aria-invalid={'problem' in entered && entered.problem !== ''}
                aria-describedby="sweep-problem"
                value={text}
                onChange={(event) => setText(event.target.value)}
              />
            </span>
            <p id="sweep-problem" className={fields.ferr} aria-live="polite">
              {'problem' in entered ? entered.problem : ''}
              {launch.error && statementOf(launch.error)}
            </p>
          </div>
          <Button wide icon={IconPlayerTrackNext} disabled={blocked || values === null || launch.isPending} onClick={() => launch.mutate()}>
            {launch.isPending ? 'Starting …' : `Start ${values?.length ?? ''} runs`.replace('  ', ' ')}
          </Button>
          {blocked && <p className="small mut">Give the run a name and solve the problems of the campaign first.</p>}
        </div>
      )}
    </Card>
  )
}

const statementOf = (error: Error): string =>
  error instanceof Refusal && error.errors.length > 0
    ? error.errors.slice(0, 3).map(({ given, message }) => `${given ? `${given}: ` : ''}${message}`).join('; ')
    : error.message
