// The catalogue entries that a run used, collapsed and loaded on demand.
import { upperFirst } from '@mantine/hooks'
import type { Catalogue } from '../../client'
import { ComponentText } from '../../help/ComponentText'
import { MethodText } from '../../help/MethodText'
import { layout } from '../../ui/styles'

export function Described({ catalogue }: { catalogue: Catalogue }) {
  const entries = [
    ...catalogue.components.map((one) => ({ ...one, what: upperFirst(one.role), text: <ComponentText component={one} open /> })),
    ...catalogue.methods.map((one) => ({ ...one, what: 'Method', text: <MethodText method={one} /> })),
  ]
  return (
    <div className={layout.stack}>
      {entries.map(({ what, name, title, text }) => (
        <details key={`${what} ${name}`}>
          <summary>
            {what}: {title} <span className="mono mut small">{name}</span>
          </summary>
          <div className={layout.stack}>{text}</div>
        </details>
      ))}
    </div>
  )
}
