// Code that could not be loaded is asked for again, and whether it is gone for good is found out.
import { Component, Suspense } from 'react'
import { renderToReadableStream } from 'react-dom/server'
import { afterEach, expect, it, vi } from 'vitest'
import { pulse } from '../api/pulse'
import { gone, later, Missed, Part } from './later'

afterEach(() => {
  vi.unstubAllGlobals()
  vi.restoreAllMocks()
})

const Hello = ({ name }: { name: string }) => <p>Hello {name}</p>
const CODE = { Hello }

it('asks for code again after a failure, and once after it came', async () => {
  const load = vi.fn<() => Promise<typeof CODE>>().mockRejectedValueOnce(new TypeError('no connection')).mockResolvedValue(CODE)
  const Late = later(load, 'Hello')
  await Late.preload()
  await Late.preload()
  await Late.preload()
  expect(load).toHaveBeenCalledTimes(2)
  const page = await new Response(await renderToReadableStream(<Part><Late name="there" /></Part>)).text()
  expect(page.replace(/<!--.*?-->/g, '')).toContain('<p>Hello there</p>')
  expect(load).toHaveBeenCalledTimes(2)
})

it('keeps a failure until it is reported, and forgets it then', async () => {
  const load = vi.fn<() => Promise<typeof CODE>>().mockRejectedValue(new TypeError('no connection'))
  const Late = later(load, 'Hello')
  const errors: unknown[] = []
  const show = () => renderToReadableStream(<Suspense><Late name="there" /></Suspense>, { onError: (error) => void errors.push(error) }).then((stream) => stream.allReady)
  await show()
  await show()
  expect(load).toHaveBeenCalledTimes(1)
  expect(errors).toHaveLength(2)
  new Part({ children: null }).componentDidCatch(errors[0])
  await show()
  expect(load).toHaveBeenCalledTimes(2)
})

it('leaves other errors to the page', () => {
  const part = new Part({ children: null })
  expect(part).toBeInstanceOf(Component)
  Object.assign(part, { state: Part.getDerivedStateFromError(new RangeError('a mistake')) })
  expect(() => part.render()).toThrow('a mistake')
})

const CAUSE = new TypeError('Failed to fetch dynamically imported module: http://service/assets/Jump-abc.js')

it.each([
  ['gone', CAUSE, new Response(null, { status: 404 }), 'http://service/assets/Jump-abc.js'],
  ['not answered for', CAUSE, new Response(null, { status: 502 }), ''],
  ['out of reach', CAUSE, null, ''],
  ['not named', new TypeError('Importing a module script failed.'), new Response(null, { status: 404 }), ''],
])('sees that code is %s', async (_, cause, answer, address) => {
  const asked = vi.fn(() => (answer ? Promise.resolve(answer) : Promise.reject(new TypeError('Failed to fetch'))))
  vi.stubGlobal('fetch', asked)
  const check = vi.spyOn(pulse, 'check').mockResolvedValue()
  expect(await gone(new Missed(cause, () => undefined))).toBe(address)
  expect(asked).toHaveBeenCalledTimes(cause === CAUSE ? 1 : 0)
  expect(check).toHaveBeenCalledTimes(address ? 0 : 1)
})
