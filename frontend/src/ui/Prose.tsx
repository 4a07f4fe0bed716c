// A sentence of the service as in print: symbols of the quantity and of parameters, numbers with their units.
import { pieces } from '../format/prose'
import { Sign } from './Sign'

interface ProseProps {
  text: string
  quantity: string
  /** Of the quantity. */
  unit?: string
  /** Uncertain parameters, by whose paths sentences name them. */
  parameters?: readonly { path: string; symbol: string; unit: string; text: string }[]
}

export function Prose({ text, quantity, unit = '', parameters = [] }: ProseProps) {
  const terms = [
    ...(quantity.includes('_') ? [{ written: quantity, symbol: quantity }] : []),
    ...parameters.map(({ path, symbol }) => ({ written: path, symbol })),
  ]
  return pieces(text, terms, ['s', unit, ...parameters.map((parameter) => parameter.unit)]).map((piece, i) =>
    'symbol' in piece ? (
      <Sign key={i} text={piece.symbol} path={piece.written === piece.symbol ? undefined : piece.written} />
    ) : (
      <span key={i}>{piece.text}</span>
    ),
  )
}
