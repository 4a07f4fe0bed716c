// Published values are those of a study only where the shipped campaign has them, whatever the run's campaign is called.
import { expect, it } from 'vitest'
import { run } from '../../../tests/fixtures'
import { asCampaign } from '../../api/campaign'
import { studyOf } from './Published'

const SHIPPED = {
  ...asCampaign(run().campaign),
  name: 'Unicycle',
  criterion: { component: 'd_min', threshold: 0.5 },
  published: [{ label: 'DIRECT', value: 0.9436 }],
}

it('finds the study by its values', () => {
  expect(studyOf(SHIPPED, [SHIPPED])).toBe('repeated')
  expect(studyOf({ ...SHIPPED, name: 'Renamed', criterion: { ...SHIPPED.criterion, threshold: 0.9 } }, [SHIPPED])).toBe('repeated')
  const moved = { ...SHIPPED, name: 'No encounter', uncertain: { 'vehicle.m': { low: 1, high: 9 } } }
  expect(studyOf(moved, [SHIPPED])).toBe('changed')
  expect(studyOf({ ...SHIPPED, criterion: { component: 'path_deviation', threshold: 0.5 } }, [SHIPPED])).toBe('changed')
  expect(studyOf({ ...SHIPPED, published: [{ label: 'DIRECT', value: 0.9 }] }, [SHIPPED])).toBe('not shipped')
})
