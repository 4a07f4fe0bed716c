// Renders a sentence of the service: formatted symbols, numbers with units.
import type { Span } from '../client'
import { quantityText } from '../format/quantity'
import { Sign } from './Sign'

export function Said({ spans }: { spans: readonly Span[] }) {
  return spans.map((span, i) => <Drawn key={i} span={span} />)
}

function Drawn({ span }: { span: Span }) {
  switch (span.kind) {
    case 'symbol':
      return <Sign text={span.symbol} path={span.name === span.symbol ? undefined : span.name} />
    case 'quantity':
      return <span>{quantityText(span)}</span>
    case 'reference':
      return <span>{span.label}</span>
    case 'text':
      return <span>{span.text}</span>
  }
}
