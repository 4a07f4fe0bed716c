// Digests in a sentence are shortened; the rest of it is as it was given.
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it } from 'vitest'
import { Digests } from './Digests'

const DIGEST = '16d4e3d04b2cf5c3c163afca65af0bbc8f391eb9aced0eb1ffb6bb871407fd4f'

it('shows the beginning of each digest, and all of it under the pointer', () => {
  const shown = renderToStaticMarkup(<Digests text={`campaign: ${DIGEST}, name: Drop`} />)
  expect(shown).toBe(`campaign: <span class="mono" title="${DIGEST}">${DIGEST.slice(0, 16)}</span>, name: Drop`)
})

it('leaves other words and shorter numbers as they are', () => {
  expect(renderToStaticMarkup(<Digests text="name: deadbeef, seed: 1" />)).toBe('name: deadbeef, seed: 1')
})
