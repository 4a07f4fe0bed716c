// Matching findings of several runs.
import { expect, it } from 'vitest'
import * as fixtures from '../../tests/fixtures'
import type { Campaign } from '../api/campaign'
import type { FindingDetail } from '../client'
import type { UncertainParameter } from '../run/data/data'
import { type Case, matched, type Parts, partsOf, type Searched } from './matching'

const finding = (label: string, m: number, J = 0) =>
  fixtures.finding(label, { parameters: { 'vehicle.m': m, 'vehicle.J': J } })
const parameters: UncertainParameter[] = ['vehicle.m', 'vehicle.J'].map((path) => ({ path, symbol: path, unit: '', text: '', nominal: 5, low: 0, high: 10 }))
const run = (...findings: FindingDetail[]): Searched => ({ findings, parameters, parts: {} })
const labels = (cases: Case[] | null) => cases?.map((one) => one.map((f) => f?.label ?? '-').join(' '))

it('puts together what lies at the same place, whatever its rank', () => {
  const a = run(finding('F1', 0), finding('F2', 9))
  const b = run(finding('F1', 8.5), finding('F2', 0.2))
  expect(labels(matched([a, b]))).toEqual(['F1 F2', 'F2 F1'])
})

it('keeps apart what differs in one parameter alone', () => {
  expect(labels(matched([run(finding('F1', 0, 0)), run(finding('F1', 0, 5))]))).toEqual(['F1 -', '- F1'])
})

it('gives each case the nearest, and each finding one case', () => {
  const a = run(finding('F1', 1), finding('F2', 1.9))
  const b = run(finding('F1', 1.8))
  expect(labels(matched([a, b]))).toEqual(['F1 -', 'F2 F1'])
  expect(labels(matched([b, a]))).toEqual(['F1 F2', '- F1'])
})

it('finds a case of the second run again in the third', () => {
  const runs = [run(), run(finding('F1', 3)), run(finding('F1', 7), finding('F2', 3))]
  expect(labels(matched(runs))).toEqual(['- F1 F2', '- - F1'])
})

it('knows no place where other parameters vary', () => {
  const other = { findings: [finding('F1', 0)], parameters: parameters.slice(1), parts: {} }
  expect(matched([run(finding('F1', 0)), other])).toBeNull()
})

it('knows no place where a list has another part at the position', () => {
  const walker = (x: number, speed: number) => ({ component: 'moving_circle', parameters: { position: { x }, speed } })
  const listing = (...obstacles: object[]) => ({ scenario: { obstacles } }) as unknown as Campaign
  const parts = (campaign: Campaign) => partsOf(campaign, ['vehicle.m', 'obstacles.0.speed'])
  const [a, b, again] = [listing(walker(6, 1), walker(3, 1)), listing(walker(3, 1), walker(6, 1)), listing(walker(6, 1.2))].map(parts)
  const at = (own: Parts | undefined) => ({ ...run(finding('F1', 0)), parts: own ?? {} })
  expect(matched([at(a), at(b)])).toBeNull()
  expect(labels(matched([at(a), at(again)]))).toEqual(['F1 F1'])
})

it('puts together the cases of a part of which another value was changed', () => {
  const walker = (x: number, radius: number) => ({ component: 'moving_circle', parameters: { position: { x, y: 1 }, radius, speed: 1 } })
  const at = (...obstacles: object[]) => ({
    ...run(finding('F1', 0)),
    parts: partsOf({ scenario: { obstacles } } as unknown as Campaign, ['vehicle.m', 'obstacles.0.speed']),
  })
  const before = at(walker(6, 0.3), walker(3, 0.3))
  expect(labels(matched([before, at(walker(6, 0.4), walker(3, 0.3))]))).toEqual(['F1 F1'])
  expect(labels(matched([before, at(walker(6, 0.4), walker(3, 0.4), walker(9, 0.3))]))).toEqual(['F1 F1'])
  expect(matched([before, at(walker(3, 0.4), walker(6, 0.4))])).toBeNull()
  expect(matched([before, at({ component: 'circle', parameters: { speed: 1 } }, walker(6, 0.3))])).toBeNull()
})
