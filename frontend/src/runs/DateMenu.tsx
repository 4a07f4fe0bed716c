// When a run was submitted: today, in the last days, or between two days.
import { DAYS, type Days, type RunsSearch } from './search'
import { Field } from '../ui/Form'
import { Menu } from '../overlay/Menu'
import { fields } from '../ui/styles'
import styles from './runs.module.css'

const NAME: Record<Days, string> = { 1: 'today', 7: 'last 7 days', 30: 'last 30 days' }

interface DateMenuProps {
  search: RunsSearch
  onChange: (change: Partial<RunsSearch>) => void
}

export function DateMenu({ search, onChange }: DateMenuProps) {
  const { days, since, until } = search
  const range = since || until ? `${since ?? '…'} to ${until ?? '…'}` : null
  const set = (change: Pick<RunsSearch, 'days' | 'since' | 'until'>) =>
    onChange({ days: undefined, since: undefined, until: undefined, ...change })
  return (
    <Menu name="Submitted" value={days ? NAME[days] : (range ?? 'any time')} on={Boolean(days || range)}>
      <div className={fields.picks} role="radiogroup" aria-label="Submitted">
        {[undefined, ...DAYS].map((choice) => (
          <label key={choice ?? 0} className={fields.pickrow}>
            <input className={fields.radio} type="radio" name="days" checked={days === choice && !range} onChange={() => set({ days: choice })} />
            {choice ? NAME[choice].charAt(0).toUpperCase() + NAME[choice].slice(1) : 'Any time'}
          </label>
        ))}
      </div>
      <div className={styles.dates}>
        <Field label="From" type="date" value={since ?? ''} max={until} onChange={(day) => set({ since: day || undefined, until })} />
        <Field label="To" type="date" value={until ?? ''} min={since} onChange={(day) => set({ since, until: day || undefined })} />
      </div>
    </Menu>
  )
}
