// Below a list that is loaded in pages: loads the next one.
import { count } from '../format/numbers'
import { Button } from './Button'

interface ShowMoreProps {
  query: { isFetchingNextPage: boolean; fetchNextPage: () => unknown }
  total: number
  words?: string
}

export function ShowMore({ query, total, words = `Show more of ${count(total)}` }: ShowMoreProps) {
  return (
    <Button small disabled={query.isFetchingNextPage} onClick={() => void query.fetchNextPage()}>
      {query.isFetchingNextPage ? 'Loading …' : words}
    </Button>
  )
}
