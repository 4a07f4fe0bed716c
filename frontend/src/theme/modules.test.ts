// Every class that code uses from a CSS module exists in it: the types accept any name.
import { readdirSync, readFileSync } from 'node:fs'
import { dirname, join, relative } from 'node:path'
import { fileURLToPath } from 'node:url'
import { expect, it } from 'vitest'

const SRC = fileURLToPath(new URL('..', import.meta.url))
const files = readdirSync(SRC, { recursive: true, encoding: 'utf-8' }).filter((file) => !file.startsWith('client'))
const read = (file: string): string => readFileSync(join(SRC, file), 'utf-8')
const camel = (name: string): string => name.replace(/-+(\w)/g, (_, letter: string) => letter.toUpperCase())

/** The classes defined by a module. */
function classesOf(file: string): Set<string> {
  const own = read(file).replace(/\/\*[^]*?\*\/|:global\([^)]*\)|\[[^\]]*\]|\{[^{}]*\}/g, ' ')
  return new Set([...own.matchAll(/\.([a-zA-Z_][\w-]*)/g)].map(([, name = '']) => camel(name)))
}

/** The classes that a file uses from each module: its own, and those that pages share. */
function taken(file: string): [string, string[]][] {
  const text = read(file)
  const code = text.replace(/^import .*$/gm, '')
  const own = [...text.matchAll(/import (\w+) from '(.*\.module\.css)'/g)].map(([, name = '', path = '']) => [name, join(dirname(file), path)])
  const shared = (/import \{ (.*) \} from '[./]+(?:ui\/)?styles'/.exec(text)?.[1]?.split(', ') ?? []).map((entry) => {
    const [module = '', name = module] = entry.split(' as ')
    return [name, `ui/${module}.module.css`]
  })
  return [...own, ...shared].map(([name = '', path = '']) => [
    relative(SRC, join(SRC, path)),
    [...code.matchAll(new RegExp(`(?<![.\\w])${name}\\.(\\w+)`, 'g'))].map(([, one = '']) => one),
  ])
}

it('has every class of a module that is used, and none that is not', () => {
  const modules = files.filter((file) => file.endsWith('.module.css'))
  expect(modules.length).toBeGreaterThan(20)
  const used = new Map(modules.map((file) => [file, new Set<string>()]))
  for (const file of files.filter((one) => /\.tsx?$/.test(one)))
    for (const [module, names] of taken(file))
      for (const name of names) {
        expect([...classesOf(module)], `${file}: ${name}`).toContain(name)
        used.get(module)?.add(name)
      }
  // The class names of compared runs' letters are computed.
  for (const [module, names] of used)
    expect([...classesOf(module)].filter((name) => !names.has(name) && !/^letter[A-D]$/.test(name)), module).toEqual([])
})

it('looks for no element by a class that a module has renamed', () => {
  const global = files.filter((file) => file.endsWith('.css') && !file.endsWith('.module.css')).map(classesOf)
  const names = files
    .filter((file) => /\.tsx?$/.test(file))
    .flatMap((file) => [...read(file).matchAll(/(?:closest|querySelector(?:All)?)(?:<\w+>)?\(\s*'([^']+)'/g)])
    .flatMap(([, selector = '']) => [...selector.matchAll(/\.([a-z][\w-]*)/g)].map(([, name = '']) => name))
    .filter((name) => !name.startsWith('u-')) // uPlot's own
  expect(names).toContain('sr')
  for (const name of names) expect(global.some((classes) => classes.has(camel(name))), name).toBe(true)
})
