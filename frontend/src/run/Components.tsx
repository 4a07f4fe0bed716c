// What the components and methods of a run meant when it began, folded; what is installed otherwise now, at once.
import { useQuery } from '@tanstack/react-query'
import { lazy, Suspense, useState } from 'react'
import { componentsQuery } from '../api/queries'
import type { RunComponents, RunDetail } from '../client'
import { Card } from '../ui/Card'

const Described = lazy(() => import('./Described').then((module) => ({ default: module.Described })))

export function Components({ run, className }: { run: RunDetail; className: string }) {
  const [open, setOpen] = useState(false)
  const { data } = useQuery(componentsQuery(run.id))
  if (!data) return null
  return (
    <Card
      title="Components"
      note={data.digest ? 'What they meant when the run began' : 'As installed now'}
      className={className}
      id="components"
      right={
        <button type="button" className="btn s" aria-expanded={open} onClick={() => setOpen(!open)}>
          {open ? 'Hide' : 'Show'}
        </button>
      }
    >
      <div className="stack">
        <Origin told={data} />
        {open && (
          <Suspense>
            <Described catalogue={data.catalogue} />
          </Suspense>
        )}
      </div>
    </Card>
  )
}

function Origin({ told: { digest, catalogue, changes } }: { told: RunComponents }) {
  if (!digest)
    return (
      <p className="sec">
        This run kept nothing of what its components meant. Texts, units, limits and default values on this page are those
        installed now (Clearance {catalogue.version}); they may not be those that flew.
      </p>
    )
  return (
    <>
      <p className="sec">
        Kept with the run, from Clearance {catalogue.version}: sha256{' '}
        <span className="mono" title={digest}>
          {digest.slice(0, 16)}
        </span>
        .{changes.length === 0 && ' What is installed now says the same.'}
      </p>
      {changes.length > 0 && (
        <div className="note warn">
          <div>
            <p className="m">This installation describes them otherwise now. The page shows what the run kept.</p>
            <ul className="listed">
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
