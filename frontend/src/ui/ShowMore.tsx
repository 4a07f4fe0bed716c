// Below a list that is loaded in pages: loads the next one.
import { count } from '../format/numbers'
import { Button } from './Button'

interface ShowMoreProps {
  query: { isFetchingNextPage: boolean; fetchNextPage: () => unknown }
  total: number
}

export function ShowMore({ query, total }: ShowMoreProps) {
  return (
    <Button small disabled={query.isFetchingNextPage} onClick={() => void query.fetchNextPage()}>
      {query.isFetchingNextPage ? 'Loading …' : `Show more of ${count(total)}`}
    </Button>
  )
}
