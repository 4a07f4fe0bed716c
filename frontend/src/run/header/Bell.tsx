// Asks for word from the browser when this run has ended.
import { IconBell, IconBellFilled } from '@tabler/icons-react'
import { useState } from 'react'
import { type Asked, toggleRun, useWanted } from '../../page/notify'

const WHY: Record<Exclude<Asked, 'granted'>, string> = {
  denied: 'The browser does not allow it; its settings for this site say so.',
  unavailable: 'The browser offers it on this machine and over HTTPS only.',
}

export function Bell({ run }: { run: string }) {
  const on = useWanted().runs.includes(run)
  const [answer, setAnswer] = useState<Asked>('granted')
  return (
    <>
      {answer !== 'granted' && <span className="small bad-t">{WHY[answer]}</span>}
      <button
        type="button"
        className="btn"
        aria-pressed={on}
        onClick={() => void toggleRun(run).then(setAnswer)}
        title="A message of the browser when this run has ended"
      >
        {on ? <IconBellFilled className="i s" aria-hidden /> : <IconBell className="i s" aria-hidden />}
        {on ? 'Will notify' : 'Notify me'}
      </button>
    </>
  )
}
