// Published values beside ours, where the campaign repeats a study. Ours is flown at the published point where one is given.
import type { Published as PublishedValue } from '../api/campaign'
import { decimalsFor, fixed, NONE, signed } from '../format/numbers'
import { Card } from '../ui/Card'
import { Sign } from '../ui/Sign'
import { type RunData, searchesOf } from './data'

export function Published({ data, className }: { data: RunData; className: string }) {
  const { run, campaign } = data
  const rows = campaign.published ?? []
  if (rows.length === 0) return null
  const decimals = decimalsFor(
    rows.map((row) => row.value),
    4,
  )
  return (
    <Card
      title="Published values"
      note="Of the study this campaign repeats"
      className={className}
      flush
      footer={campaign.notes ? <Notes text={campaign.notes} /> : undefined}
    >
      <table className="tight">
        <thead>
          <tr>
            <th>Value</th>
            <th className="num">
              Published
              <br />
              <span className="u">{run.unit}</span>
            </th>
            <th className="num">
              Ours
              <br />
              <span className="u">{run.unit}</span>
            </th>
            <th className="num">
              Difference
              <br />
              <span className="u">{run.unit}</span>
            </th>
          </tr>
        </thead>
        <tbody>
          {rows.map((row) => {
            const ours = oursFor(data, row)
            return (
              <tr key={row.label}>
                <td>
                  <span className="rn">
                    <span>{row.label}</span>
                    <small>
                      {[row.source, where(data, row)].filter(Boolean).map((part, i) => (
                        // biome-ignore lint/suspicious/noArrayIndexKey: two fixed parts
                        <span key={i}>
                          {i > 0 && ', '}
                          {part}
                        </span>
                      ))}
                    </small>
                  </span>
                </td>
                <td className="num">{fixed(row.value, decimals)}</td>
                <td className="num b">{ours === null ? NONE : fixed(ours, decimals + 1)}</td>
                <td className="num sec">{ours === null ? NONE : signed(ours - row.value, decimals + 1)}</td>
              </tr>
            )
          })}
        </tbody>
      </table>
    </Card>
  )
}

function Notes({ text }: { text: string }) {
  return (
    <details>
      <summary>How this campaign was made</summary>
      <p className="about">{text}</p>
    </details>
  )
}

function where({ parameters }: RunData, row: PublishedValue) {
  const points = Object.entries(row.at ?? {})
  if (points.length === 0) return null
  return points.map(([path, value], i) => (
    <span key={path} className="nw">
      {i > 0 && ', '}
      <Sign text={parameters.find((p) => p.path === path)?.symbol ?? path} /> = {value}
    </span>
  ))
}

/** Our value for a published one, by the method its label names; a start it names picks that start's own minimum. */
function oursFor(data: RunData, row: PublishedValue): number | null {
  const label = row.label.toLowerCase()
  if (label.startsWith('nominal')) return data.run.nominal_cost
  const search = searchesOf(data).find(({ title, stage }) => {
    const words = [title, stage.method?.replaceAll('_', ' ') ?? ''].map((word) => word.toLowerCase())
    return words.some((word) => word && label.startsWith(word.split(' ')[0] ?? word))
  })
  if (!search) return null
  if (!label.includes(' from ')) return search.stage.best
  const numbers = [...row.label.matchAll(/=\s*([\d.]+)/g)].map((match) => Number(match[1]))
  const minimum = search.result?.minima.find(({ start }) => {
    const values = Object.values(start ?? {})
    return numbers.every((n) => values.some((v) => Math.abs(v - n) < 1e-6 * Math.max(1, Math.abs(n))))
  })
  return minimum?.cost ?? null
}
