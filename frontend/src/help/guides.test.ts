// The guides in the help: every file has an entry, every link stays within the pages.
import { readdirSync, readFileSync } from 'node:fs'
import { fileURLToPath } from 'node:url'
import { createElement } from 'react'
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, test } from 'vitest'
import { Markdown } from '../ui/Markdown'
import { fragmentOf, GUIDES, parts, sectionsOf, shown } from './guides'

const DOCS = fileURLToPath(new URL('../../../docs', import.meta.url))
const textOf = (name: string): string => readFileSync(`${DOCS}/${name}.md`, 'utf8')

test('every guide is listed under its own title', () => {
  const files = readdirSync(DOCS).filter((file) => file.endsWith('.md'))
  expect(GUIDES.map(({ name }) => `${name}.md`).sort()).toEqual(files.sort())
  for (const { name, title } of GUIDES) expect(textOf(name).split('\n')[0]).toBe(`# ${title}`)
})

test('links between guides become addresses of the pages', () => {
  expect(shown('# Title\n\n[a](methods.md), [b](operation.md#set-up)\n')).toBe(
    '\n[a](/help/guides/methods), [b](/help/guides/operation#set-up)\n',
  )
  for (const { name } of GUIDES)
    for (const [, target = ''] of shown(textOf(name)).matchAll(/[^!]\[[^\]]*\]\(([^)\s]+)\)/g))
      expect(target).toMatch(/^(https?:|\/help\/guides\/|#)/)
})

test('links to a section of a guide land there', () => {
  const ids = new Map<string, string[]>(
    GUIDES.map(({ name }) => {
      const html = renderToStaticMarkup(createElement(Markdown, { text: shown(textOf(name)), idOf: fragmentOf }))
      return [name, [...html.matchAll(/<h\d id="([^"]+)"/g)].map(([, id = '']) => id)]
    }),
  )
  const links = GUIDES.flatMap(({ name }) =>
    [...shown(textOf(name)).matchAll(/\]\((?:\/help\/guides\/([\w-]+))?#([\w-]+)\)/g)].map(([, guide = name, section = '']) => ({ guide, section })),
  )
  expect(links.length).toBeGreaterThan(10)
  for (const { guide, section } of links) expect(ids.get(guide), guide).toContain(section)
})

test('the sections of a guide are those of its text, not of its code', () => {
  expect(sectionsOf('# T\n## A `b` c\n```\n## no\n```\n## D\n## E\n')).toEqual([
    { title: 'In this guide', entries: [{ id: 'a-b-c', name: 'A b c' }, { id: 'd', name: 'D' }, { id: 'e', name: 'E' }] },
  ])
  expect(sectionsOf('## One\n')).toEqual([])
})

test('pictures are parts of their own', () => {
  expect(parts('before\n\n![What](images/a.svg)\n\nafter')).toEqual(['before\n\n', { alt: 'What', file: 'a.svg' }, '\n\nafter'])
  const pictures = GUIDES.flatMap(({ name }) => parts(textOf(name)).filter((part) => typeof part !== 'string'))
  expect(pictures.map(({ file }) => file)).toEqual(['architecture.svg', 'view-states.svg'])
  for (const { file } of pictures) expect(readdirSync(`${DOCS}/images`)).toContain(file)
})

test('every guide is rendered whole: no Markdown is left as it was written', () => {
  const texts = GUIDES.flatMap(({ name }) => parts(shown(textOf(name)))).filter((part) => typeof part === 'string')
  const html = texts.map((text) => renderToStaticMarkup(createElement(Markdown, { text }))).join('')
  const prose = html.replace(/<pre[^>]*>.*?<\/pre>|<code>.*?<\/code>/gs, '')
  expect(prose).toContain('<table')
  expect(prose).not.toMatch(/\]\(|```|\*\*|^#|&lt;!--/m)
})
