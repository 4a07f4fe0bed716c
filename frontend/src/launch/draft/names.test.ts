// A run is called as its campaign until the user says otherwise; an opened, dropped or pasted file brings its own name.
import { expect, it } from 'vitest'
import * as fixtures from '../../../tests/fixtures'
import { asCampaign, type Campaign } from '../../api/campaign'
import { followed, isAnother } from './useNames'

const named = (name: string, tags: string[]): Campaign => ({ ...asCampaign(fixtures.run().campaign), name, tags })
const UNICYCLE = named('Unicycle, static obstacle', ['unicycle'])
const QUADROTOR = named('Quadrotor, wall', ['quadrotor', 'hover'])
const own = (more: object = {}) => ({ name: UNICYCLE.name, tags: ['unicycle'], of: UNICYCLE, replaced: false, ...more })

it('follows the campaign', () => {
  expect(followed(own(), QUADROTOR)).toMatchObject({ name: 'Quadrotor, wall', tags: ['quadrotor', 'hover'] })
})

it('keeps what the user gave while the same campaign is edited', () => {
  const mine = own({ name: 'Heavier', tags: ['mine'] })
  expect(followed(mine, named('Unicycle, static obstacle 2', []))).toMatchObject({ name: 'Heavier', tags: ['mine'] })
})

it('takes name and tags of another campaign, also in place of those that the user gave', () => {
  const mine = own({ name: 'Heavier', tags: ['mine'], replaced: true })
  const after = followed(mine, QUADROTOR)
  expect(after).toMatchObject({ name: 'Quadrotor, wall', tags: ['quadrotor', 'hover'], replaced: false })
})

const OLD = 'name: Unicycle\nscenario:\n  horizon: 10\nuncertain: {}\nseed: 1\n'
const NEW = 'name: Quadrotor\nsimulator: {name: quad}\nuncertain: {mass: {plus_minus: 10%}}\nseed: 1\n'

it.each([
  ['a pasted file', OLD, NEW, true],
  ['a file pasted into an empty editor', '\n', NEW, true],
  ['a typed letter', OLD, OLD.replace('10', '101'), false],
  ['a pasted block', OLD, OLD.replace('uncertain: {}', 'uncertain:\n  vehicle.m: {plus_minus: 10%}'), false],
  ['everything deleted', OLD, '', false],
])('knows %s', (_, before, after, another) => {
  expect(isAnother(before, after)).toBe(another)
})
