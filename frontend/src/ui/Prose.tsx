// A sentence of the service with the symbol of the quantity set as in print.
import { Sign } from './Sign'

export function Prose({ text, quantity }: { text: string; quantity: string }) {
  if (!quantity.includes('_')) return text
  return text.split(quantity).map((part, i) => (
    <span key={i}>
      {i > 0 && <Sign text={quantity} />}
      {part}
    </span>
  ))
}
