// What each search method does and guarantees, from the catalogue: the text is that of the method's own file.
import { useQuery } from '@tanstack/react-query'
import { Link } from '@tanstack/react-router'
import { catalogueQuery } from '../api/queries'
import { Loading, Trouble } from '../app/Trouble'
import { useTitle } from '../app/useTitle'
import type { MethodEntry } from '../client'
import { count } from '../format/numbers'
import { MethodName } from '../ui/MethodMark'
import { Docstring } from './Docstring'
import { HelpFrame } from './HelpFrame'

const KINDS: Record<MethodEntry['kind'], { name: string; text: string }> = {
  global: { name: 'Global', text: 'Looks everywhere. The global methods must agree before anything is cleared.' },
  local: { name: 'Local', text: 'Goes down from its starts. It shows how deep a valley is, not whether there is a deeper one.' },
  random: {
    name: 'Random',
    text: 'Draws from the stated distributions. It bears the statement on P(violation), and says little of the worst case.',
  },
  multi: { name: 'Several criteria', text: 'Looks for the front where no criterion can be lowered but by raising another.' },
}
const ORDER: readonly MethodEntry['kind'][] = ['global', 'local', 'random', 'multi']

export function MethodsPage() {
  useTitle('Search methods')
  const query = useQuery(catalogueQuery)
  if (query.isError) return <Trouble error={query.error} retry={() => void query.refetch()} />
  if (!query.data) return <Loading what="the methods" />
  const kinds = ORDER.flatMap((kind) => {
    const methods = query.data.methods.filter((method) => method.kind === kind)
    return methods.length > 0 ? [{ kind, methods }] : []
  })
  return (
    <HelpFrame
      title="Search methods"
      lede={
        <>
          Each is written after its paper, with the paper’s settings as the usual ones. None can show that it found the
          worst case: what a <Link to="/help">verdict</Link> takes is that several of them agree.
        </>
      }
      contents={kinds.map(({ kind, methods }) => ({
        title: KINDS[kind].name,
        entries: methods.map(({ name, title }) => ({ id: name, name: <MethodName method={name} title={title} /> })),
      }))}
    >
      {kinds.map(({ kind, methods }) => (
        <section key={kind} className="stack">
          <h2 className="sect">
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

interface Rule {
  type?: string
  default?: unknown
  description?: string
  minimum?: number
  maximum?: number
  enum?: unknown[]
  anyOf?: Rule[]
}

function Method({ method }: { method: MethodEntry }) {
  const options = Object.entries((method.options.properties ?? {}) as Record<string, Rule>)
  return (
    <section className="card" id={method.name}>
      <div className="h">
        <h3>
          <MethodName method={method.name} title={method.title} />
        </h3>
        <span className="d">{method.how}</span>
      </div>
      <div className="bd stack">
        <Docstring text={method.text} />
        <dl className="guarantee">
          <dt>In a campaign</dt>
          <dd className="mono">{method.name}</dd>
          <dt>Source</dt>
          <dd>{method.source}</dd>
          <dt>Usual budget</dt>
          <dd>{count(method.evaluations)} evaluations</dd>
          {method.starts && (
            <>
              <dt>Starts</dt>
              <dd>from points that the campaign gives</dd>
            </>
          )}
        </dl>
        {options.length > 0 && (
          <details>
            <summary>{options.length === 1 ? 'One setting' : `${options.length} settings`}</summary>
            <table className="tight">
              <thead>
                <tr>
                  <th>Setting</th>
                  <th>Usual value</th>
                  <th>Meaning</th>
                </tr>
              </thead>
              <tbody>
                {options.map(([name, rule]) => (
                  <tr key={name}>
                    <td className="mono">{name}</td>
                    <td className="tn nw">{rule.default === undefined ? 'must be given' : said(rule.default)}</td>
                    <td className="sec">{meaning(rule)}</td>
                  </tr>
                ))}
              </tbody>
            </table>
          </details>
        )}
      </div>
    </section>
  )
}

const said = (value: unknown): string =>
  value === null ? 'none' : typeof value === 'string' || typeof value === 'number' ? String(value) : JSON.stringify(value)

function meaning(rule: Rule): string {
  const of = rule.anyOf?.find((option) => option.type !== 'null') ?? rule
  const limits =
    of.minimum !== undefined && of.maximum !== undefined
      ? `${of.minimum} to ${of.maximum}`
      : of.enum
        ? of.enum.map(said).join(', ')
        : ''
  return [rule.description, limits].filter(Boolean).join(' · ')
}
