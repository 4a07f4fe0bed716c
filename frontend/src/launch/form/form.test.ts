// Tests the form with every campaign of the library: it covers every field, and the round trip through JSON and YAML
// gives the same campaign. The repository's Python code reads, checks and writes the campaigns.
import { beforeAll, describe, expect, it } from 'vitest'
import { type Campaign, fieldOf, place, type Raw, read, without, write } from '../../api/campaign'
import type { Catalogue } from '../../client'
import { parse, field as shown } from '../../format/numbers'
import { listOf, listText } from '../fields/NumberCell'
import { parametersOf, sectionsOf } from '../campaign/parameters'
import { python, shipped, type ShippedCampaigns } from '../../../tests/repository'
import { settingOf, settled, SIMULATION, STAGES, VERDICT } from '../campaign/settings'
import { amended, changesOf, formOf } from '../text'

const THROUGH_YAML = `
import json, sys
from campaigns.asked.load import load_document, load_text
from campaigns.asked.text import to_yaml
again = {name: load_text(to_yaml(load_document(d, name)), name) for name, d in json.load(sys.stdin).items()}
print(json.dumps({name: {"document": c.document(), "digest": c.digest} for name, c in again.items()}))
`

let catalogue: Catalogue
let campaigns: ShippedCampaigns
let schema: unknown

beforeAll(() => {
  const library = shipped()
  catalogue = library.catalogue
  campaigns = library.campaigns
  schema = library.schema
})

const each = (hold: (campaign: Campaign, name: string) => void) => {
  const found = Object.entries(campaigns)
  expect(found.length).toBeGreaterThanOrEqual(34)
  for (const [name, { document }] of found) hold(document, name)
}

/** The fields of a document, by the service's names. */
function leaves(value: unknown, at: string[] = []): string[] {
  if (typeof value !== 'object' || value === null) return value === null ? [] : [at.join('.')]
  return Object.entries(value).flatMap(([key, inner]) => leaves(inner, [...at, key]))
}

const SETTINGS = [...SIMULATION, ...STAGES.flatMap((group) => group.settings), ...VERDICT]

/** The fields that the form shows of a campaign. */
function reached(campaign: Campaign): Set<string> {
  const sections = sectionsOf(campaign, catalogue)
  return new Set([
    ...sections.flatMap(({ at, parameters }) => [
      `${at.join('.')}.component`,
      `${at.join('.')}.on`,
      ...parameters.map((parameter) => parameter.field),
    ]),
    ...SETTINGS.map(({ at }) => at.join('.')),
    'criterion.threshold',
    'scenario.realisations.combine',
    'name',
    'summary',
    'notes',
  ])
}

/** Shown as rows with any content. */
const ROWS =
  /^(uncertain|correlations|tags|scenario\.realisations\.seeds|stages\.search\.\d+\.(method|evaluations|options|starts)|published\.\d+\.(label|value|source))\b/
/** Neither shown nor changed by the form. */
const KEPT = /^(version|published\.\d+\.at\..*)$/

it('reaches every field of every campaign', () => {
  each((campaign, name) => {
    const known = reached(campaign)
    const missed = leaves(campaign).filter((leaf) => !known.has(leaf) && !ROWS.test(leaf) && !KEPT.test(leaf))
    expect(missed, name).toEqual([])
    const strays = sectionsOf(campaign, catalogue).flatMap((section) => section.strays)
    expect(strays, name).toEqual([])
  })
})

it('keeps every digit of what it shows', () => {
  const through = (value: Raw | null) => (value === null ? null : parse(typeof value === 'number' ? shown(value) : value))
  each((campaign, name) => {
    let again = campaign
    for (const parameter of parametersOf(campaign, catalogue))
      if (read(campaign, place(parameter.path)) !== undefined)
        again = write(again, place(parameter.path), through(parameter.nominal))
    for (const setting of SETTINGS)
      if (settingOf(campaign, setting) !== null) again = write(again, ...settled(setting, through(settingOf(campaign, setting))))
    const seeds = campaign.scenario.realisations?.seeds ?? []
    again = write(again, ['scenario', 'realisations', 'seeds'], listOf(listText(seeds)))
    expect(again, name).toEqual(campaign)
  })
})

it('loses nothing by way of YAML and back', () => {
  const edited = Object.fromEntries(
    Object.entries(campaigns).map(([name, { document }]) => {
      const first = parametersOf(document, catalogue).find(({ path }) => path in document.uncertain)
      return [name, write(document, place(first?.path ?? ''), read(document, place(first?.path ?? '')) ?? first?.nominal)]
    }),
  )
  const again = python<ShippedCampaigns>(THROUGH_YAML, JSON.stringify(edited))
  for (const [name, { document }] of Object.entries(again)) expect(document, name).toEqual(edited[name])
  const untouched = python<ShippedCampaigns>(THROUGH_YAML, JSON.stringify(Object.fromEntries(Object.entries(campaigns).map(([n, c]) => [n, c.document]))))
  for (const [name, { digest }] of Object.entries(untouched)) expect(digest, name).toBe(campaigns[name]?.digest)
})

it('takes a draft that is no campaign yet back into the form', () => {
  each((campaign, name) => {
    const typed = write(campaign, ['scenario', 'horizon'], '45 s')
    expect(formOf(JSON.stringify(typed, null, 2), schema), name).toEqual(typed)
    const text = amended(campaigns[name]?.text ?? '', changesOf(campaign, typed))
    expect(formOf(text, schema), name).toEqual({ ...typed, correlations: typed.correlations ?? [] })
  })
  const whole = JSON.stringify(campaigns.unicycle_static?.document)
  const wrong = ['', '{}', '[1]', 'name: x', '{"scenario": {"vehicle": {}}}', whole.replace('"goal":{', '"goal":[{').replace('}', '}]')]
  for (const text of wrong) expect(formOf(text, schema), text).toBeNull()
})

describe('taking a part out', () => {
  it('moves the paths of those behind it up, and drops its own', () => {
    const campaign = campaigns.uav_three_intruders?.document as Campaign
    const path = (i: number, name: string) => `obstacles.${i}.${name}`
    const campaignOfThree: Campaign = {
      ...campaign,
      uncertain: { 'vehicle.m': {}, [path(0, 'speed')]: { low: 1 }, [path(1, 'speed')]: {}, [path(2, 'speed')]: { low: 3 } },
      correlations: [
        { between: [path(0, 'speed'), path(2, 'speed')], value: 0.5 },
        { between: [path(1, 'speed'), 'vehicle.m'], value: 0.5 },
      ],
      stages: { search: [{ method: 'sqp', evaluations: 1, starts: [{ [path(1, 'speed')]: 1, [path(2, 'speed')]: 2 }] }] },
      published: [{ label: 'a', value: 1, at: { [path(2, 'speed')]: 2 } }],
    }
    const left = without(campaignOfThree, 'obstacles', 1)
    expect(left.scenario.obstacles).toEqual([campaign.scenario.obstacles?.[0], campaign.scenario.obstacles?.[2]])
    expect(left.uncertain).toEqual({ 'vehicle.m': {}, [path(0, 'speed')]: { low: 1 }, [path(1, 'speed')]: { low: 3 } })
    expect(left.correlations).toEqual([{ between: [path(0, 'speed'), path(1, 'speed')], value: 0.5 }])
    expect(left.stages.search[0]?.starts).toEqual([{ [path(1, 'speed')]: 2 }])
    expect(left.published?.[0]?.at).toEqual({ [path(1, 'speed')]: 2 })
  })
  it('finds further criteria by their place', () => {
    const campaign = campaigns.uav_moving_criteria?.document as Campaign
    expect(fieldOf('objectives.0.radius')).toBe('objectives.0.parameters.radius')
    expect(without(campaign, 'objectives', 0).objectives).toEqual(campaign.objectives?.slice(1))
  })
})
