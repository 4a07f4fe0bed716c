// The section of the attraction stage: the region about trim that is proved for the polynomial model.
import { resultWith } from '../../api/stages'
import { AttractionCard } from '../attraction/AttractionCard'
import { type Added, section } from '../section'

export const added: Added = {
  after: 'validation',
  section: section({
    id: 'attraction',
    of: ({ data }) => resultWith(data.stages, 'contradicting'),
    title: 'Attraction',
    pieces: (_, result) => [
      { height: result.sections.length > 0 ? 520 : 150, card: <AttractionCard key="attraction" result={result} /> },
    ],
  }),
}
