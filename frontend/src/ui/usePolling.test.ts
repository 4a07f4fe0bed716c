// A poll waits for its last answer.
import { expect, it, vi } from 'vitest'
import { inTurn } from './usePolling'

it('asks again once the answer has come or failed, and after a minute without one', async () => {
  const clock = vi.spyOn(performance, 'now').mockReturnValue(0)
  const turn = inTurn()
  const answers: { come: () => void; fail: (error: Error) => void }[] = []
  const ask = vi.fn(() => new Promise<void>((come, fail) => answers.push({ come, fail })))
  turn(ask)
  turn(ask)
  expect(ask).toHaveBeenCalledTimes(1)
  answers[0]?.come()
  await vi.waitFor(() => {
    turn(ask)
    expect(ask).toHaveBeenCalledTimes(2)
  })
  answers[1]?.fail(new Error('no connection'))
  await vi.waitFor(() => {
    turn(ask)
    expect(ask).toHaveBeenCalledTimes(3)
  })
  clock.mockReturnValue(59_000)
  turn(ask)
  expect(ask).toHaveBeenCalledTimes(3)
  clock.mockReturnValue(61_000)
  turn(ask)
  expect(ask).toHaveBeenCalledTimes(4)
  answers[2]?.come()
  await Promise.resolve()
  turn(ask)
  expect(ask).toHaveBeenCalledTimes(4)
  const broken = inTurn()
  broken(() => {
    throw new Error('at once')
  })
  await vi.waitFor(() => {
    broken(ask)
    expect(ask).toHaveBeenCalledTimes(5)
  })
  clock.mockRestore()
})
