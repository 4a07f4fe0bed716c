// Folders have no circular imports: neither folders of files, nor sibling folders.
import { readdirSync, readFileSync } from 'node:fs'
import { dirname, join, sep } from 'node:path'
import { fileURLToPath } from 'node:url'
import { expect, test } from 'vitest'

type Arrows = Map<string, Map<string, string>>

const SRC = fileURLToPath(new URL('..', import.meta.url))
const MODULES = readdirSync(SRC, { recursive: true, encoding: 'utf8' })
  .map((path) => path.split(sep).join('/'))
  .filter((path) => /\.tsx?$/.test(path) && !path.startsWith('client/'))
const IMPORT = /(?:\bfrom|\bimport)\s*\(?\s*['"](\.[^'"]*)['"]/g

/** The module that a relative import leads to; undefined for styles and for the generated client. */
function targetOf(module: string, specifier: string): string | undefined {
  const path = join(dirname(module), specifier).split(sep).join('/')
  return ['.ts', '.tsx', '/index.ts'].map((end) => path + end).find((one) => MODULES.includes(one))
}

/** All imports as [module, imported module]. */
const IMPORTS = MODULES.flatMap((module) =>
  [...readFileSync(join(SRC, module), 'utf8').matchAll(IMPORT)]
    .map(([, specifier = '']) => [module, targetOf(module, specifier)] as const)
    .filter((pair): pair is readonly [string, string] => pair[1] !== undefined),
)

/** The folders of two modules below their common parent: `run/data` and `run/search`, or `run` and `api`. */
function apart(one: string, other: string): [string, string] {
  const [a, b] = [one.split('/'), other.split('/')]
  const same = a.findIndex((part, at) => part !== b[at])
  return [a.slice(0, same + 1).join('/'), b.slice(0, same + 1).join('/')]
}

function arrowsOf(imports: readonly (readonly [string, string])[], ends: (from: string, to: string) => [string, string]) {
  const arrows: Arrows = new Map()
  for (const [from, to] of imports) {
    const [a, b] = ends(from, to)
    if (a !== b) arrows.set(a, (arrows.get(a) ?? new Map<string, string>()).set(b, `${from} imports ${to}`))
  }
  return arrows
}

/** One import for every edge that is part of a cycle. */
function circles(arrows: Arrows): string[] {
  const reached = (start: string) => {
    const seen = new Set<string>()
    const waiting = [start]
    for (let next = waiting.pop(); next !== undefined; next = waiting.pop())
      for (const to of arrows.get(next)?.keys() ?? [])
        if (!seen.has(to)) {
          seen.add(to)
          waiting.push(to)
        }
    return seen
  }
  const after = new Map([...arrows.keys()].map((folder) => [folder, reached(folder)]))
  return [...arrows].flatMap(([from, ends]) => [...ends].filter(([to]) => after.get(to)?.has(from)).map(([, line]) => line))
}

test('no folder imports another in a circle', () => {
  expect(circles(arrowsOf(IMPORTS, (from, to) => [dirname(from), dirname(to)]))).toEqual([])
})

test('no folder imports a sibling folder in a circle', () => {
  const between = IMPORTS.filter(([from, to]) => apart(from, to).every((one) => !MODULES.includes(one)))
  expect(circles(arrowsOf(between, apart))).toEqual([])
})

test('the imports are read, and a circle among them is found', () => {
  expect(IMPORTS).toContainEqual(['app/router.tsx', 'run/data/chosen.ts'])
  expect(IMPORTS).toContainEqual(['app/lazy.ts', 'runs/RunsPage.tsx'])
  expect(IMPORTS).toContainEqual(['launch/draft/useDraft.ts', 'launch/text/index.ts'])
  const made = [...IMPORTS, ['run/data/data.ts', 'run/search/Minima.tsx'], ['api/calls.ts', 'run/RunPage.tsx']] as const
  const found = circles(arrowsOf(made, apart))
  expect(found).toContain('run/data/data.ts imports run/search/Minima.tsx')
  expect(found).toContain('api/calls.ts imports run/RunPage.tsx')
})
