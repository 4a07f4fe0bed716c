// Toggles the browser notification at the end of this run.
import { IconBell, IconBellFilled } from '@tabler/icons-react'
import { toggleRun, useToggle, useWanted } from '../../page/notify'
import { Button } from '../../ui/Button'

export function Bell({ run }: { run: string }) {
  const on = useWanted().runs.includes(run)
  const [why, press] = useToggle(() => toggleRun(run))
  return (
    <>
      {why && <span className="small bad-t">{why}</span>}
      <Button aria-pressed={on} onClick={press} title="Browser notification when this run ends">
        {on ? <IconBellFilled className="i s" aria-hidden /> : <IconBell className="i s" aria-hidden />}
        {on ? 'Will notify' : 'Notify me'}
      </Button>
    </>
  )
}
