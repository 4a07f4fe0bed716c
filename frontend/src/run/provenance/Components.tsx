// The component and method descriptions of a run, collapsed, and their differences from the installation.
import { clsx } from 'clsx'
import { useQuery } from '@tanstack/react-query'
import { useState } from 'react'
import { componentsQuery } from '../../api/queries'
import type { RunComponents, RunDetail } from '../../client'
import { later, Part } from '../../page/later'
import { namesOf, unreadOf } from '../../trends/code'
import { Button } from '../../ui/Button'
import { Card } from '../../ui/Card'
import { Digest } from '../../ui/Digests'
import { cards, layout, lists } from '../../ui/styles'

const Described = later(() => import('./Described'), 'Described')

export function Components({ run }: { run: RunDetail }) {
  const [open, setOpen] = useState(false)
  const { data } = useQuery(componentsQuery(run.id))
  if (!data) return null
  return (
    <Card
      title="Components"
      note={data.digest ? 'Descriptions at the start of the run' : 'As installed now'}
      className={layout.c12}
      id="components"
      right={
        <Button small aria-expanded={open} onClick={() => setOpen(!open)}>{open ? 'Hide' : 'Show'}</Button>
      }
    >
      <div className={layout.stack}>
        <Origin record={data} />
        <Code record={data} />
        {open && (
          <Part>
            <Described catalogue={data.catalogue} />
          </Part>
        )}
      </div>
    </Card>
  )
}

/** Equal descriptions do not imply equal code. */
const sameCode = ({ code, code_installed, code_changes, unidentified }: RunComponents) =>
  code !== null && code_installed !== null && code_changes.length === 0 && unidentified.length === 0

function Code({ record }: { record: RunComponents }) {
  const { code, code_changes: names, unidentified } = record
  if (names.length > 0)
    return (
      <div className={clsx(cards.note, cards.warn)}>
        <div>
          <p className="m">
            The code installed now is not the one that simulated this run
            {code && (
              <>
                , <Digest of={code} first={12} />
              </>
            )}
            . The same campaign may give other results.
          </p>
          <p className="small">What differs: {namesOf(names, MOST)}.</p>
        </div>
      </div>
    )
  if (sameCode(record))
    return (
      <p className="sec">
        Simulated by code <Digest of={code ?? ''} first={12} />, the code installed now.
      </p>
    )
  if (code)
    return (
      <p className="sec">
        Simulated by code <Digest of={code} first={12} />. No live worker reports the code that is installed now
        {unidentified.length > 0 && ` completely: ${unidentified.join(', ')}`}.
      </p>
    )
  return <p className="sec">The code of this run cannot be compared with the installed one: {unreadOf(record)}.</p>
}

const MOST = 8

function Origin({ record }: { record: RunComponents }) {
  const { digest, catalogue, changes } = record
  if (!digest)
    return (
      <p className="sec">
        This run did not store the descriptions of its components. Texts, units, limits and default values on this page are those
        installed now (Clearance {catalogue.version}); they may differ from those of the run.
      </p>
    )
  return (
    <>
      <p className="sec">
        Stored with the run, from Clearance {catalogue.version}: sha256 <Digest of={digest} />.{changes.length === 0 && (sameCode(record) ? ' The installed components are the same.' : ' The texts that a worker published last are the same.')}
      </p>
      {changes.length > 0 && (
        <div className={clsx(cards.note, cards.warn)}>
          <div>
            <p className="m">This installation describes them differently. The page shows what is stored with the run.</p>
            <ul className={lists.listed}>
              {changes.map((change) => (
                <li key={change}>{change}</li>
              ))}
            </ul>
          </div>
        </div>
      )}
    </>
  )
}
