// The search methods and their guarantees, from the catalogue: the texts are the methods' docstrings.
import { useQuery } from '@tanstack/react-query'
import { Link } from '@tanstack/react-router'
import { catalogueQuery } from '../api/queries'
import { useTitle } from '../page/useTitle'
import type { MethodEntry } from '../client'
import { MethodName } from '../ui/MethodMark'
import { Chapters, HelpFrame, Unread } from './HelpFrame'
import { MethodText } from './MethodText'

const KINDS: Record<MethodEntry['kind'], { title: string; note: string }> = {
  global: { title: 'Global', note: 'Searches the whole range. The global methods must agree before a run is cleared.' },
  local: { title: 'Local', note: 'Descends from its start points. It finds the bottom of a valley, not whether a deeper one exists.' },
  random: {
    title: 'Random',
    note: 'Draws from the stated distributions. It supports the statement on P(violation), but gives little information on the worst case.',
  },
  multi: { title: 'Several criteria', note: 'Searches for the Pareto front: no criterion can improve without worsening another.' },
}
const ORDER: readonly MethodEntry['kind'][] = ['global', 'local', 'random', 'multi']

export function MethodsPage() {
  useTitle('Search methods')
  const query = useQuery(catalogueQuery)
  const kinds = ORDER.map((kind) => {
    const methods = (query.data?.methods ?? []).filter((method) => method.kind === kind)
    const entries = methods.map((method) => {
      const title = <MethodName method={method.name} title={method.title} />
      return { id: method.name, name: title, title, note: method.how, text: <MethodText method={method} /> }
    })
    return { ...KINDS[kind], entries }
  }).filter(({ entries }) => entries.length > 0)
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
      contents={kinds}
    >
      {!query.data && <Unread what="the methods" query={query} />}
      <Chapters of={kinds} />
    </HelpFrame>
  )
}
