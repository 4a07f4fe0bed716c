// The search methods and their guarantees, from the catalogue: the texts are the methods' docstrings.
import { useQuery } from '@tanstack/react-query'
import { Link } from '@tanstack/react-router'
import { catalogueQuery } from '../api/queries'
import { useTitle } from '../page/useTitle'
import type { MethodEntry } from '../client'
import { Card } from '../ui/Card'
import { MethodName } from '../ui/MethodMark'
import { HelpFrame, Unread } from './HelpFrame'
import { MethodText } from './MethodText'
import { layout } from '../ui/styles'

const KINDS: Record<MethodEntry['kind'], { name: string; text: string }> = {
  global: { name: 'Global', text: 'Searches the whole range. The global methods must agree before a run is cleared.' },
  local: { name: 'Local', text: 'Descends from its start points. It finds the bottom of a valley, not whether a deeper one exists.' },
  random: {
    name: 'Random',
    text: 'Draws from the stated distributions. It supports the statement on P(violation), but gives little information on the worst case.',
  },
  multi: { name: 'Several criteria', text: 'Searches for the Pareto front: no criterion can improve without worsening another.' },
}
const ORDER: readonly MethodEntry['kind'][] = ['global', 'local', 'random', 'multi']

export function MethodsPage() {
  useTitle('Search methods')
  const query = useQuery(catalogueQuery)
  const kinds = ORDER.flatMap((kind) => {
    const methods = (query.data?.methods ?? []).filter((method) => method.kind === kind)
    return methods.length > 0 ? [{ kind, methods }] : []
  })
  return (
    <HelpFrame
      title="Search methods"
      lede={
        <>
          Each names its source; where its defaults differ from it, the option <code>as_published</code> restores them. No method
          can prove that it found the worst case: to be <Link to="/help">cleared</Link>, methods of two families must agree, or
          the two sides of Auto.
        </>
      }
      contents={kinds.map(({ kind, methods }) => ({
        title: KINDS[kind].name,
        entries: methods.map(({ name, title }) => ({ id: name, name: <MethodName method={name} title={title} /> })),
      }))}
    >
      {!query.data && <Unread what="the methods" query={query} />}
      {kinds.map(({ kind, methods }) => (
        <section key={kind} className={layout.stack}>
          <h2 className={layout.sect}>
            {KINDS[kind].name} <span className="small mut">{KINDS[kind].text}</span>
          </h2>
          {methods.map((method) => (
            <Method key={method.name} method={method} />
          ))}
        </section>
      ))}
    </HelpFrame>
  )
}

function Method({ method }: { method: MethodEntry }) {
  return (
    <Card inner id={method.name} title={<MethodName method={method.name} title={method.title} />} note={method.how}>
      <div className={layout.stack}>
        <MethodText method={method} />
      </div>
    </Card>
  )
}
