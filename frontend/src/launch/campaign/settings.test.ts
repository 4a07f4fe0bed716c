// What an empty field says of its stage.
import { expect, it } from 'vitest'
import type { Campaign } from '../../api/campaign'
import { STAGES } from './settings'

it('calls a stage omitted only where it is', () => {
  const { empty } = STAGES.flatMap(({ settings }) => settings).find(({ at }) => at.join('.') === 'stages.attraction.degree') ?? {}
  const said = (attraction: object | null) => typeof empty === 'function' && empty({ stages: { attraction } } as Campaign)
  expect([said(null), said({}), said({ degree: 4 })]).toEqual(['omitted', 'by the number of states', 'by the number of states'])
})
