// A sentence of the service about a run, with the run's own symbols and units.
import { Prose } from '../../ui/Prose'
import type { RunData } from './data'

export function Said({ data: { run, parameters }, text }: { data: Pick<RunData, 'run' | 'parameters'>; text: string }) {
  return <Prose text={text} quantity={run.quantity} unit={run.unit} parameters={parameters} />
}
