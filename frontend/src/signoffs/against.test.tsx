// Who signs is shown the runs that speak against the verdict, and must state a reason.
import { QueryClient, QueryClientProvider } from '@tanstack/react-query'
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it } from 'vitest'
import { run } from '../../tests/fixtures'
import { SignForm } from './SignoffsCard'

it.each([
  [{}, false],
  [{ 'R-0001': 'violates', 'R-0002': 'beyond', 'R-0003': 'violates' }, true],
])('with %j asks for a reason: %s', (against, asked) => {
  const seen = { digest: '0'.repeat(64), can_sign: true, barred: null, signs_as: 'grace', texts: {}, against, not_carried: null, items: [] }
  const shown = renderToStaticMarkup(
    <QueryClientProvider client={new QueryClient()}>
      <SignForm run={run({ verdict: 'cleared' })} seen={seen} onDone={() => undefined} />
    </QueryClientProvider>,
  )
  expect(shown.includes('R-0001, R-0003 violate the criterion; R-0002 saw beyond the horizon')).toBe(asked)
  expect(/<textarea[^>]* required/.test(shown)).toBe(asked)
})
