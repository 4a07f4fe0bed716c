// Toggles the browser notification at the end of this run.
import { IconBell, IconBellFilled } from '@tabler/icons-react'
import { useState } from 'react'
import { type Asked, toggleRun, useWanted } from '../../page/notify'
import { Button } from '../../ui/Button'

const WHY: Record<Exclude<Asked, 'granted'>, string> = {
  denied: 'Blocked by the browser’s settings for this site.',
  unavailable: 'The browser allows this only on this machine or over HTTPS.',
}

export function Bell({ run }: { run: string }) {
  const on = useWanted().runs.includes(run)
  const [answer, setAnswer] = useState<Asked>('granted')
  return (
    <>
      {answer !== 'granted' && <span className="small bad-t">{WHY[answer]}</span>}
      <Button aria-pressed={on} onClick={() => void toggleRun(run).then(setAnswer)} title="Browser notification when this run ends">
        {on ? <IconBellFilled className="i s" aria-hidden /> : <IconBell className="i s" aria-hidden />}
        {on ? 'Will notify' : 'Notify me'}
      </Button>
    </>
  )
}
