import { beforeEach, expect, test, vi } from 'vitest'

beforeEach(() => vi.resetModules())

const canvas = (context: unknown) => ({ getContext: () => context }) as unknown as HTMLCanvasElement

test('a browser with WebGL 2 draws, and its context is given back', async () => {
  const { drawable } = await import('./drawable')
  const loseContext = vi.fn()
  expect(drawable(() => canvas({ getExtension: () => ({ loseContext }) }))).toBe(true)
  expect(loseContext).toHaveBeenCalledOnce()
})

test('a browser without it does not, and is asked once', async () => {
  const { drawable } = await import('./drawable')
  expect(drawable(() => canvas(null))).toBe(false)
  expect(drawable(() => canvas({ getExtension: () => null }))).toBe(false)
})
