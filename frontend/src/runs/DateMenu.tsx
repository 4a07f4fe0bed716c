// When a run was submitted: today, in the last days, or between two days.
import { DAYS, type Days, type RunsSearch } from './search'
import { Menu } from '../ui/Menu'
import fields from '../ui/fields.module.css'
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
        <label className={fields.lbl}>
          From
          <input
            type="date"
            className={fields.inp}
            value={since ?? ''}
            max={until}
            onChange={(event) => set({ since: event.target.value || undefined, until })}
          />
        </label>
        <label className={fields.lbl}>
          To
          <input
            type="date"
            className={fields.inp}
            value={until ?? ''}
            min={since}
            onChange={(event) => set({ since, until: event.target.value || undefined })}
          />
        </label>
      </div>
    </Menu>
  )
}
