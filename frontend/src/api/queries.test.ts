// What is requested while it changes is requested again.
import { QueryObserver } from '@tanstack/react-query'
import { expect, test, vi } from 'vitest'
import { Cache } from './queries'

test.each(['first', 'later'])('a %s request that was under way when something changed is made again', async (which) => {
  const cache = new Cache()
  const answers: ((value: string) => void)[] = []
  const queryFn = () => new Promise<string>((answer) => answers.push(answer))
  const watch = new QueryObserver(cache, { queryKey: ['signoffs', 'R-0001'], queryFn, staleTime: Number.POSITIVE_INFINITY })
  const leave = watch.subscribe(() => undefined)
  if (which === 'later') {
    answers.shift()?.('first')
    await vi.waitFor(() => expect(watch.getCurrentResult().data).toBe('first'))
    void watch.refetch()
  }
  const changed = cache.invalidateQueries({ queryKey: ['signoffs'] })
  answers[0]?.('before the change')
  answers[1]?.('after it')
  await changed
  expect(watch.getCurrentResult()).toMatchObject({ data: 'after it', isError: false, fetchStatus: 'idle' })
  leave()
  cache.clear()
})

test('a request that no page waits for is not cancelled', async () => {
  const cache = new Cache()
  let answer: (value: string) => void = () => undefined
  const ahead = cache.fetchQuery({ queryKey: ['run'], queryFn: () => new Promise<string>((done) => (answer = done)) })
  await cache.invalidateQueries({ queryKey: ['run'] })
  answer('run')
  expect(await ahead).toBe('run')
  cache.clear()
})
