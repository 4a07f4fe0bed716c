// Completions and descriptions of the editor, with the real catalogue, schema and campaigns.
import { CompletionContext } from '@codemirror/autocomplete'
import { EditorState } from '@codemirror/state'
import { beforeAll, expect, it } from 'vitest'
import type { Campaign } from '../../api/campaign'
import type { Catalogue } from '../../client'
import { shipped } from '../../../tests/repository'
import { fieldAt, placeOf, tolerant } from '../text/places'
import { plain } from '../text/tree'
import { choicesIn, completed } from './complete'
import { hintOf, type Known } from './hints'
import type { Schema } from '../../api/schema'

let catalogue: Catalogue
let campaign: Campaign
let text: string
let schema: Schema
beforeAll(() => {
  const library = shipped()
  catalogue = library.catalogue
  schema = library.schema as Schema
  campaign = library.campaigns.unicycle_static?.document as Campaign
  text = library.campaigns.unicycle_static?.text ?? ''
})

const known = (typedText: string): Known => ({ catalogue, campaign, schema, document: plain(tolerant(typedText)) })

/** What is offered where `|` stands, put in the place of some words of the text. */
function offered(words: string, typed: string): string[] {
  expect(text).toContain(words)
  const typedText = text.replace(words, typed)
  const at = typedText.indexOf('|', text.indexOf(words))
  const whole = typedText.slice(0, at) + typedText.slice(at + 1)
  return choicesIn(whole, at, known(whole))?.choices.map(({ name }) => name) ?? []
}

it('offers keys, components, parameters and methods where they may stand', () => {
  expect(offered('  horizon: 15.0', '  |\n  horizon: 15.0')).toEqual(['environment', 'faults', 'guidance', 'realisations'])
  expect(offered('component: potential_field', 'component: po|')).toContain('orca')
  expect(offered('component: potential_field', 'component: |')).not.toContain('unicycle')
  expect(offered('{k_att: 5.0, k_rep: 4.0, d_0: 2.0}', '{k_att: 5.0, |}')).toEqual(['k_rep', 'd_0'])
  expect(offered('{k_att: 5.0, k_rep: 4.0, d_0: 2.0}', '\n      k_re|')).toEqual(['k_att', 'k_rep', 'd_0'])
  expect(offered('radius: 0.5}', 'ra|}')).toContain('radius')
  expect(offered('method: direct', 'method: |')).toEqual(catalogue.methods.map(({ name }) => name))
  expect(offered('options: {iterations: 100}', 'options: {iterations: 100, |}')).toContain('epsilon')
  expect(offered('\nuncertain:\n', '\nuncertain:\n  avoider.|\n')).toContain('avoider.k_rep')
  expect(offered('plus_minus: 20%, unit: kg}', 'plus_minus: 20%, |}')).toEqual(['low', 'high', 'unit', 'distribution'])
  expect(offered('plus_minus: 20%, unit: kg}', 'unit: |}')).toEqual(['kg'])
  expect(offered('plus_minus: 20%, unit: kg}', 'distribution: {kind: |}}')).toContain('triangular')
  expect(offered('\nagreement', '\n|\nagreement')).toContain('correlations')
  expect(offered('\nagreement', '\n# sea|\nagreement')).toEqual([])
  expect(offered('Unicycle, static', 'Uni|')).toEqual([])
})

it('waits for the schema where only the schema knows the choices', async () => {
  let there: Schema | undefined
  let arrive = () => {}
  const arriving = new Promise<void>((resolve) => (arrive = resolve))
  const requests: boolean[] = []
  const source = completed(
    (typedText) => ({ ...known(typedText), schema: there }),
    (explicit) => {
      requests.push(explicit)
      return there ? null : arriving
    },
  )
  const ask = (doc: string, explicit = true) => source(new CompletionContext(EditorState.create({ doc }), doc.length, explicit))
  const waited = ask(`${text}\n`)
  expect(waited).toBeInstanceOf(Promise)
  there = schema
  arrive()
  const labels = (await waited)?.options.map(({ label }) => label)
  expect(labels).toContain('correlations')
  expect(ask(`${text}\n`)).toMatchObject({ from: text.length + 1 })
  there = undefined
  requests.length = 0
  expect(ask('scenario:\n  vehicle: {component: ')).toMatchObject({ from: 33 })
  expect(requests, 'it is requested, but not waited for').toEqual([true])
  expect(ask('scenario:\n  vehicle: {component: u', false)).toMatchObject({ from: 33 })
  expect(requests, 'not at every key').toEqual([true])
})

it('describes a field from the catalogue, with unit and bounds', () => {
  const at = (...steps: (string | number)[]) => hintOf(known(text), steps)
  const mass = catalogue.components.find(({ name }) => name === 'unicycle')?.parameters.find(({ name }) => name === 'm')
  const hint = at('scenario', 'vehicle', 'parameters', 'm')
  expect(hint?.title).toBe(mass?.text)
  expect(hint?.detail).toMatch(/^kg, 0\.\d+ to .*, default 5$/)
  expect(at('uncertain', 'vehicle.m', 'low')?.title).toContain(mass?.text)
  expect(at('scenario', 'obstacles', 0, 'parameters', 'position.x')?.detail).toMatch(/^m, ±/)
  expect(at('scenario', 'vehicle', 'component')?.detail).toBe('vehicle, 2D')
  expect(at('stages', 'search', 0, 'method')?.title).toBe('DIRECT')
  expect(at('stages', 'search', 0, 'options', 'iterations')?.text).not.toBe('')
  expect(at('scenario', 'horizon')).toMatchObject({ title: 'Horizon', text: 'Duration of a simulation' })
  expect(at('nothing', 'of', 'this')).toBeNull()
})

it('leads from every field of the form to its place in the text and back', () => {
  const tree = tolerant(text)
  for (const field of [
    'scenario.vehicle.parameters.m',
    'scenario.obstacles.0.parameters.position.x',
    'uncertain.vehicle.J.plus_minus',
    'stages.search.1.starts.0.vehicle.m',
    'criterion.threshold',
  ]) {
    const [from, to] = placeOf(tree, field)
    expect(fieldAt(tree, from)?.at.join('.'), field).toBe(field)
    expect(text.slice(from, to), field).toMatch(/^[\d.]+%?$/)
  }
})

it('leads to what is nearest where the field is not there', () => {
  const tree = tolerant(text)
  const lineOf = (field: string) => text.slice(0, placeOf(tree, field)[0]).split('\n').length
  const line = (words: string) => text.slice(0, text.indexOf(words)).split('\n').length
  expect(lineOf('scenario.avoider.parameters.none_such')).toBe(line('parameters: {k_att'))
  expect(lineOf('scenario.faults.3.component')).toBe(line('scenario:'))
  expect(lineOf('line 7, column 3')).toBe(7)
  expect(lineOf('line 100000, column 3')).toBe(text.split('\n').length)
  expect(lineOf('')).toBe(1)
  const broken = text.replace('step: 0.005', 'step: [0.005')
  expect(placeOf(tolerant(broken), 'scenario.vehicle.parameters.m')).toEqual(placeOf(tree, 'scenario.vehicle.parameters.m'))
})
