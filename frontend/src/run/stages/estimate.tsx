// The section of the estimate stage: P(violation) over the modes that are known.
import { resultWith } from '../../api/stages'
import { EstimateCard } from '../sample/EstimateCard'
import { type Added, section } from '../section'

export const added: Added = {
  after: 'sample',
  section: section({
    id: 'estimate',
    of: ({ data }) => resultWith(data.stages, 'alarms'),
    title: 'Estimate',
    pieces: ({ data, validation }, result) => [
      {
        height: 190 + 34 * result.modes.length,
        card: <EstimateCard key="estimate" parameters={data.parameters} result={result} named={validation?.modes ?? null} />,
      },
    ],
  }),
}
