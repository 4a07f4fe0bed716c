// Toggles for stages and for evaluations without a value, with the numbers drawn.
import { count } from '../../format/numbers'
import { Entry } from '../../charts/Legend'
import { Mark } from '../../ui/MethodMark'
import { FATES, type Space } from './space'
import { figures } from '../../ui/styles'

interface TogglesProps {
  space: Space
  hidden: ReadonlySet<string>
  onToggle: (key: string) => void
}

const OUTLINES = { failed: 'M1.8 1.8l6.4 6.4M8.2 1.8l-6.4 6.4', excluded: 'M1.7 1.7h6.6v6.6H1.7z' } as const

export function Toggles({ space, hidden, onToggle }: TogglesProps) {
  const numbers = FATES.map((_, fate) => space.fates.reduce((sum, of) => sum + (of === fate ? 1 : 0), 0))
  return (
    <div className={figures.lg} role="group" aria-label="Shown evaluations">
      {space.groups.map((group) => (
        <Entry
          key={group.key}
          on={!hidden.has(group.key)}
          title={`${count(group.shown)} of ${count(group.total)} evaluations shown`}
          onToggle={() => onToggle(group.key)}
        >
          <Mark method={group.method} />
          {group.title} <span className="mut">{count(group.shown)}</span>
        </Entry>
      ))}
      {(['failed', 'excluded'] as const).map((fate) =>
        numbers[FATES.indexOf(fate)] ? (
          <Entry
            key={fate}
            on={!hidden.has(fate)}
            title={`Without a value: ${fate === 'failed' ? 'a cross and a dashed line' : 'a square and a dotted line'}; of more than 400, faint lines`}
            onToggle={() => onToggle(fate)}
          >
            <svg className={figures.mk} viewBox="0 0 10 10" aria-hidden="true">
              <path d={OUTLINES[fate]} fill="none" stroke="var(--ink-3)" strokeWidth={1.6} />
            </svg>
            {fate === 'failed' ? 'Failed' : 'Excluded'} <span className="mut">{count(numbers[FATES.indexOf(fate)])}</span>
          </Entry>
        ) : null,
      )}
    </div>
  )
}
