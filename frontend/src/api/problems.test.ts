// What the service refuses is shown as a sentence, whatever it begins and ends with.
import { expect, it } from 'vitest'
import { Refusal, statement } from './problems'

it('makes a sentence of a detail', () => {
  expect(statement("there is no run 'R-1'")).toBe("There is no run 'R-1'.")
  expect(statement('The disk is full.')).toBe('The disk is full.')
  expect(statement('vehicle.mass: low 3.0 must be below high 2.0 [kg]')).toBe('vehicle.mass: low 3.0 must be below high 2.0 [kg].')
})

it('uses the title where there is no detail', () => {
  expect(new Refusal(422, 'The campaign has problems', '').message).toBe('The campaign has problems.')
})
