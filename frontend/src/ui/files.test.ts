// A file is saved before its content is let go.
import { afterEach, beforeEach, expect, it, vi } from 'vitest'
import { save } from './files'

beforeEach(() => {
  vi.useFakeTimers()
})
afterEach(() => {
  vi.unstubAllGlobals()
  vi.restoreAllMocks()
  vi.useRealTimers()
})

it('keeps the content while the browser reads it, and no longer', () => {
  const link = { href: '', download: '', click: vi.fn() }
  vi.stubGlobal('document', { createElement: () => link })
  const revoked = vi.spyOn(URL, 'revokeObjectURL')
  save('R-0001.csv', 'a,b', 'text/csv')
  expect(link.download).toBe('R-0001.csv')
  expect(link.click).toHaveBeenCalledOnce()
  vi.advanceTimersByTime(30_000)
  expect(revoked).not.toHaveBeenCalled()
  vi.advanceTimersByTime(10_000)
  expect(revoked).toHaveBeenCalledExactlyOnceWith(link.href)
})
