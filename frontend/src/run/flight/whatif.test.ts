// The what-if in the address, and its request.
import { describe, expect, it } from 'vitest'
import type { FindingDetail } from '../../client'
import type { UncertainParameter } from '../data/data'
import { baseOf, otherCodeOf, readWhatIf, requestOf, stepped, valuesOf, withValue, written } from './whatif'

const mass: UncertainParameter = { path: 'vehicle.m', symbol: 'm', unit: 'kg', text: 'Mass', nominal: 5, low: 4, high: 6 }
const inertia: UncertainParameter = { path: 'vehicle.J', symbol: 'J', unit: 'kg m2', text: '', nominal: 0.05, low: 0.04, high: 0.06 }
const worst = { label: 'F1', parameters: { 'vehicle.m': 5.999999999999999, 'vehicle.J': 0.059999999999999998 } } as unknown as FindingDetail
const known = { parameters: [mass, inertia], findings: [worst] }

describe('the address', () => {
  it('is empty while it is closed', () => {
    expect(readWhatIf({}, known)).toBeNull()
    expect(written(null)).toEqual({ whatif: undefined, set: undefined, noise: undefined })
  })

  it('is read and written with every digit', () => {
    const whatIf = { like: 'F1', set: { 'vehicle.m': 0.1 + 5.2, 'vehicle.J': 0.05 }, seed: 7 }
    expect(readWhatIf(written(whatIf), known)).toEqual(whatIf)
    expect(written(whatIf)).toEqual({ whatif: 'F1', set: [`vehicle.m:${String(0.1 + 5.2)}`, 'vehicle.J:0.05'], noise: 7 })
  })

  it('is taken for no more than the campaign has', () => {
    const address = { whatif: 'F9', set: ['vehicle.m:60', 'vehicle.mass:5', 'vehicle.J:wide', 'vehicle.J:'] }
    expect(readWhatIf(address, known)).toEqual({ like: 'nominal', set: { 'vehicle.m': 6 }, seed: null })
  })
})

it('begins at the finding bit by bit, and goes back there', () => {
  const begun = { like: 'F1', set: {}, seed: null }
  expect(baseOf('F1', known)).toEqual(worst.parameters)
  expect(valuesOf(begun, known)).toEqual(worst.parameters)
  const changed = withValue(begun, mass, 4.5, known)
  expect(changed.set).toEqual({ 'vehicle.m': 4.5 })
  expect(valuesOf(changed, known)).toEqual({ 'vehicle.m': 4.5, 'vehicle.J': worst.parameters['vehicle.J'] })
  expect(withValue(changed, mass, 5.999999999999999, known)).toEqual(begun)
  expect(withValue(begun, mass, 99, known).set).toEqual({ 'vehicle.m': 6 })
  expect(begun.set).toEqual({})
})

it('keeps a value that lies a last digit beyond a bound, as findings at bounds do', () => {
  const beyond = 0.060000000000000005
  expect(beyond).toBeGreaterThan(inertia.high)
  const begun = { like: 'nominal', set: {}, seed: null }
  expect(withValue(begun, inertia, beyond, known).set).toEqual({ 'vehicle.J': beyond })
  expect(readWhatIf({ whatif: 'nominal', set: [`vehicle.J:${String(beyond)}`] }, known)?.set).toEqual({ 'vehicle.J': beyond })
  expect(withValue(begun, inertia, 0.0601, known).set).toEqual({ 'vehicle.J': 0.06 })
})

it('asks for what differs, drawn in its own view', () => {
  expect(requestOf({ like: 'F1', set: { 'vehicle.m': 4.5 }, seed: null }, 'k')).toMatchObject({ like: 'F1', parameters: { 'vehicle.m': 4.5 }, view: 'k' })
  expect(requestOf({ like: 'F1', set: {}, seed: null }, 'k')).not.toHaveProperty('seed')
  expect(requestOf({ like: 'nominal', set: {}, seed: 0 }, 'k')).toHaveProperty('seed', 0)
})

it('steps through the range and stops at its ends', () => {
  expect(stepped(mass, 5, 20)).toBeCloseTo(5.1)
  expect(stepped(mass, 5.99, 20)).toBe(6)
  expect(stepped(mass, 4, -1)).toBe(4)
})

describe('the code of the answer', () => {
  it('is named where it is not that of the run', () => {
    expect(otherCodeOf({ code_changes: [], code_known: true })).toBe('')
    expect(otherCodeOf({ code_changes: ['simulators/pendulum'], code_known: true })).toBe('Simulated by other code than this run: simulators/pendulum.')
    expect(otherCodeOf({ code_changes: [], code_known: false })).toBe('Whether this run had the code installed now is not known.')
  })
})
