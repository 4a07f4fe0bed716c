// The section of the baseline stage: what has become of the findings that it evaluated.
import { SinceCard } from '../regression/SinceCard'
import { type Added, section } from '../section'

export const added: Added = {
  after: 'findings',
  section: section({
    id: 'since',
    of: ({ data }) => data.run.baseline,
    title: 'Since the baseline',
    count: ({ data }) => data.run.summary?.regression?.cases.length,
    card: ({ data }) => <SinceCard data={data} />,
  }),
}
