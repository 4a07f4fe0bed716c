// The catalogue entries that a run used, collapsed and loaded on demand.
import type { Catalogue } from '../../client'
import { ComponentText } from '../../help/ComponentText'
import { MethodText } from '../../help/MethodText'
import { layout } from '../../ui/styles'

export function Described({ catalogue }: { catalogue: Catalogue }) {
  return (
    <div className={layout.stack}>
      {catalogue.components.map((component) => (
        <details key={`${component.role} ${component.name}`}>
          <summary>
            {component.role.charAt(0).toUpperCase() + component.role.slice(1)}: {component.title}{' '}
            <span className="mono mut small">{component.name}</span>
          </summary>
          <div className={layout.stack}>
            <ComponentText component={component} open />
          </div>
        </details>
      ))}
      {catalogue.methods.map((method) => (
        <details key={method.name}>
          <summary>
            Method: {method.title} <span className="mono mut small">{method.name}</span>
          </summary>
          <div className={layout.stack}>
            <MethodText method={method} />
          </div>
        </details>
      ))}
    </div>
  )
}
