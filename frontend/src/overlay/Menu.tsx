// A button with a panel of choices below it.
import { clsx } from 'clsx'
import { IconChevronDown } from '@tabler/icons-react'
import type { ReactNode } from 'react'
import { Popup } from './Popup'
import { buttons, fields, layout } from '../ui/styles'

interface MenuProps {
  name: string
  value: ReactNode
  on: boolean
  icon?: ReactNode
  /** Opens upwards without a portal, because its container may be in full screen. */
  above?: boolean
  children: ReactNode
}

export function Menu({ name, value, on, icon, above, children }: MenuProps) {
  return (
    <Popup
      kind="dialog"
      position={above ? 'top-end' : 'bottom-start'}
      width={280}
      withinPortal={!above}
      dropdown={{ 'aria-label': name }}
      button={{
        className: clsx('m nw', buttons.chip, on && buttons.on),
        children: (
          <>
            {icon}
            <span className={clsx(layout.cut, buttons.cuts)}>
              {name}
              {value !== null && <span className={on ? undefined : buttons.unset}>: {value}</span>}
            </span>
            <IconChevronDown className="i mut" aria-hidden />
          </>
        ),
      }}
    >
      <div className={fields.panel}>{children}</div>
    </Popup>
  )
}

/** The choices of a menu as checkboxes. */
export const Picks = ({ label, children }: { label: string; children: ReactNode }) => (
  <div className={fields.picks} role="group" aria-label={label}>
    {children}
  </div>
)

interface PickProps {
  on: boolean
  onChange: (on: boolean) => void
  children: ReactNode
}

export const Pick = ({ on, onChange, children }: PickProps) => (
  <label className={fields.pickrow}>
    <input className={fields.check} type="checkbox" checked={on} onChange={(event) => onChange(event.target.checked)} />
    {children}
  </label>
)
