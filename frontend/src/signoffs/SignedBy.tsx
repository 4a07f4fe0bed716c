// Who signed, with the standing of each sign-off: in the lists of requirements and of reports.
import { IconAlertTriangle, IconCircleX, IconRepeat, IconSignature } from '@tabler/icons-react'
import { capital } from '../api/problems'
import type { Signoff } from '../client'
import { moment } from '../format/time'
import { tables } from '../ui/styles'

export type Standing = Signoff['standing']

export const STANDINGS: Readonly<Record<Standing, { word: string; tone: 'ok-t' | 'unk-t' | 'bad-t'; icon: typeof IconSignature }>> = {
  standing: { word: 'Valid', tone: 'ok-t', icon: IconSignature },
  'carried on': { word: 'Carried on', tone: 'ok-t', icon: IconRepeat },
  suspect: { word: 'Suspect', tone: 'unk-t', icon: IconAlertTriangle },
  'of other results': { word: 'Results have changed', tone: 'bad-t', icon: IconCircleX },
  withdrawn: { word: 'Withdrawn', tone: 'bad-t', icon: IconCircleX },
}

/** The standing as a sentence, below the word of the standing, which is not repeated. */
export const detailOf = ({ sentence }: Signoff): string => capital(sentence.replace(/^(suspect:|withdrawn) /, ''))

export function SignedBy({ items }: { items: readonly Signoff[] }) {
  return (
    <span className={tables.rn}>
      {items.map((one) => {
        const { tone, icon: Icon } = STANDINGS[one.standing]
        return (
          <span key={one.id} className={`${tables.rn ?? ''} ${tone}`} title={`${one.role}, ${moment(one.created)}`}>
            <span>
              <Icon className="i s" aria-hidden /> {one.name}
              {one.typed && <span className="mut small"> as typed</span>}
            </span>
            {(one.standing !== 'standing' || one.own) && <small>{capital(one.sentence)}</small>}
          </span>
        )
      })}
    </span>
  )
}
