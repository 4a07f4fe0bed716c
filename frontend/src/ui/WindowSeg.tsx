// The switch between the encounter and the whole flight, the same on every chart over time or position.
import { Seg } from './Card'

export type Shown = 'encounter' | 'all'

interface WindowSegProps {
  label: string
  value: Shown
  onChange: (value: Shown) => void
}

export function WindowSeg({ label, value, onChange }: WindowSegProps) {
  return (
    <Seg
      label={label}
      options={[
        { value: 'encounter', label: 'Encounter' },
        { value: 'all', label: 'Whole flight' },
      ]}
      value={value}
      onChange={onChange}
    />
  )
}
