// Results of the search dialog.
import { expect, it } from 'vitest'
import type { Catalogue, LibraryCampaign, RunSummary } from '../client'
import { kept, matching, placesOf } from './places'

const LIBRARY = [
  { id: 'uav_moving', document: { name: 'UAV, moving obstacle', summary: 'An intruder crosses.' } },
  { id: 'unicycle_static', document: { name: 'Unicycle, static obstacle', summary: 'A post.' } },
] as unknown as LibraryCampaign[]
const CATALOGUE = {
  methods: [{ name: 'direct', title: 'DIRECT' }],
  components: [{ role: 'vehicle', name: 'unicycle', title: 'Unicycle', dimension: 2 }],
  simulators: [{ name: 'two_basins', title: 'Two basins' }],
} as unknown as Catalogue
const places = placesOf(LIBRARY, CATALOGUE)
const names = (text: string) => matching(places, text).map((place) => place.name)

it('offers the pages before anything is typed', () => {
  expect(names('')).toContain('Compare')
  expect(names('  ')).not.toContain('DIRECT')
})

it('finds every word, in name or note', () => {
  expect(names('obstacle uav')).toEqual(['UAV, moving obstacle'])
  expect(names('uav post')).toEqual([])
})

it('puts names that begin so first', () => {
  expect(names('uni')).toEqual(['Unicycle, static obstacle', 'Unicycle'])
  expect(names('search')).toEqual(['Search methods', 'DIRECT'])
})

it('knows where each leads', () => {
  expect(matching(places, 'vehicle').map((place) => place.to)).toEqual(['/help/components#vehicle-unicycle'])
  expect(matching(places, 'simulator').map((place) => place.to)).toEqual([
    '/help/guides/your-own-simulator',
    '/help/components#simulator-two_basins',
  ])
  expect(matching(places, 'moving').map((place) => place.to)).toEqual(['/launch?case=uav_moving'])
})

it('keeps no run of an earlier text that this text does not find', () => {
  const runs = [
    { id: 'R-0001', name: 'Full box', campaign_name: 'Unicycle', tags: ['baseline'] },
    { id: 'R-0002', name: 'Once more', campaign_name: 'Drop', tags: [] },
  ] as unknown as RunSummary[]
  const found = (text: string) => kept(runs, text).map(({ id }) => id)
  expect(found('')).toEqual(['R-0001', 'R-0002'])
  expect(found('BASE uni')).toEqual(['R-0001'])
  expect(found('webhook')).toEqual([])
})
