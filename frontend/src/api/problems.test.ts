// What the service refuses is shown as a sentence, whatever it begins and ends with.
import { expect, it } from 'vitest'
import { Refusal, refusalOf, statement } from './problems'

it('makes a sentence of a detail', () => {
  expect(statement("there is no run 'R-1'")).toBe("There is no run 'R-1'.")
  expect(statement('The disk is full.')).toBe('The disk is full.')
  expect(statement('vehicle.mass: low 3.0 must be below high 2.0 [kg]')).toBe('vehicle.mass: low 3.0 must be below high 2.0 [kg].')
})

it('uses the title where there is no detail', () => {
  expect(new Refusal(422, 'The campaign has problems', '').message).toBe('The campaign has problems.')
})

it('tells the answer of a proxy from that of the service', () => {
  const answer = (status: number, kind: string) => new Response(null, { status, headers: { 'Content-Type': kind } })
  const said = (status: number) => `The service does not answer: a proxy in between says ${status}. Try again in a moment.`
  for (const status of [502, 503, 504]) expect(refusalOf('<html>', answer(status, 'text/html')).message).toBe(said(status))
  const busy = { title: 'Service Unavailable', detail: 'too many previews' }
  expect(refusalOf(busy, answer(503, 'application/problem+json')).message).toBe('Too many previews.')
  expect(refusalOf('<html>', answer(500, 'text/html')).message).toBe('Answer 500.')
})
