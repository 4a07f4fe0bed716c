// Renders a sentence of the service: formatted symbols, numbers with units.
import type { Span } from '../client'
import { nameOf } from '../format/names'
import { exactText, quantityText, readDigits } from '../format/quantity'
import { isPath, Sign } from './Sign'

interface SpansProps {
  spans: readonly Span[]
  /** With the digits of the service, for the conditions of a claim; otherwise with as many as are read. */
  exact?: boolean
}

export function Spans({ spans, exact = false }: SpansProps) {
  const quantities = spans.filter((span) => span.kind === 'quantity')
  const read = exact ? [] : readDigits(quantities)
  return spans.map((span, i) => (
    <Drawn key={i} span={span} digits={span.kind === 'quantity' ? read[quantities.indexOf(span)] : undefined} />
  ))
}

function Drawn({ span, digits }: { span: Span; digits: number | undefined }) {
  switch (span.kind) {
    case 'symbol':
      // Earlier versions printed the path of a parameter whose symbol another one has.
      if (isPath(span.symbol) && span.symbol === span.name) return <Sign text={nameOf(span.name)} path={span.name} />
      return <Sign text={span.symbol} path={span.name === span.symbol ? undefined : span.name} />
    case 'quantity':
      return <span title={exactText(span)}>{quantityText({ ...span, digits: digits ?? span.digits })}</span>
    case 'reference':
      return <span>{span.label}</span>
    case 'text':
      return <span>{span.text}</span>
  }
}
