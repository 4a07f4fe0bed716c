// Values as YAML text, as a person would write them: small mappings and lists in one line, parts on lines of their own.
// Start reading at `lines`.
import { stringify } from 'yaml'
import type { Json } from '../../api/campaign'

/** Lines become no longer than this where they can be broken. */
const WIDTH = 100

type Mapping = { [key: string]: Json }
export const isMapping = (value: unknown): value is Mapping =>
  typeof value === 'object' && value !== null && !Array.isArray(value)

// What a reader of YAML 1.1 takes for the end of a line, or refuses.
const HIDDEN = /[\u007f-\u00a0\u2028\u2029\ufeff]/g
const quoted = (text: string): string =>
  JSON.stringify(text).replace(HIDDEN, (sign) => `\\u${sign.charCodeAt(0).toString(16).padStart(4, '0')}`)

/** Text without quotes where it means the same everywhere; `on`, `yes` and the like are quoted for other readers. */
function word(text: string): string {
  const bare = /^[A-Za-z0-9_+(][\w .,;+*/()%=-]*$/.test(text) && !/\s$|^(y|n|yes|no|on|off)$/i.test(text)
  return bare && !text.includes(', ') && stringify(text, { lineWidth: 0 }).trimEnd() === text ? text : quoted(text)
}

/** A scalar in one line. */
export function scalar(value: Json, json = false): string {
  if (typeof value === 'string') return json ? JSON.stringify(value) : word(value)
  return JSON.stringify(value)
}

export const key = (name: string, json = false): string => scalar(name, json)

/** A value in one line. */
export function inline(value: Json, json = false): string {
  if (Array.isArray(value)) return `[${value.map((inner) => inline(inner, json)).join(', ')}]`
  if (!isMapping(value)) return typeof value === 'string' && !json && value.includes(',') ? quoted(value) : scalar(value, json)
  return `{${Object.entries(value)
    .map(([name, inner]) => `${key(name, json)}: ${inline(inner, json)}`)
    .join(', ')}}`
}

const isPart = (value: Json): boolean => isMapping(value) && 'component' in value

/** Whether a value stands in one line behind so many characters. */
export function fits(value: Json, before: number): boolean {
  if (typeof value === 'string') return !value.includes('\n')
  if (!Array.isArray(value) && !isMapping(value)) return true
  const inner = Object.values(value)
  if (inner.length === 0) return true
  const deep = inner.some((one) => typeof one === 'object' && one !== null && Object.values(one).some((v) => typeof v === 'object' && v !== null))
  return !deep && !isPart(value) && !inner.some(isPart) && before + inline(value).length <= WIDTH
}

/** Lines of text behind `|`, indented by so many spaces; the header first. */
export function literal(text: string, indent: number): string[] {
  const body = text.replace(/\n+$/, '')
  const ends = text.length - body.length
  const chomping = ends === 0 ? '-' : ends === 1 ? '' : '+'
  const pad = ' '.repeat(indent)
  const content = body.split('\n').map((line) => (line === '' ? '' : pad + line))
  return [`|${chomping}`, ...content, ...Array<string>(Math.max(0, ends - 1)).fill('')]
}

/** Whether text over several lines can stand as it is. */
export const isLiteral = (text: string): boolean =>
  text.includes('\n') && /^\S/.test(text) && !/[^\n\P{Cc}]/u.test(text) && text.search(HIDDEN) < 0

/** A pair of a mapping: its first line and those below it. */
export function pairLines(name: string, value: Json, indent: number): string[] {
  const pad = ' '.repeat(indent)
  const head = `${pad}${key(name)}:`
  if (typeof value === 'string' && isLiteral(value)) {
    const [mark = '', ...rest] = literal(value, indent + 2)
    return [`${head} ${mark}`, ...rest]
  }
  if (fits(value, head.length + 1)) return [`${head} ${isMapping(value) || Array.isArray(value) ? inline(value) : scalar(value)}`]
  return typeof value === 'string' ? [`${head} ${quoted(value)}`] : [head, ...lines(value, indent + 2)]
}

/** A mapping or a list over several lines, indented by so many spaces. */
export function lines(value: Json, indent: number): string[] {
  const pad = ' '.repeat(indent)
  if (Array.isArray(value))
    return value.flatMap((item) => {
      if (fits(item, indent + 2)) return [`${pad}- ${isMapping(item) || Array.isArray(item) ? inline(item) : scalar(item)}`]
      if (typeof item === 'string') return [`${pad}- ${quoted(item)}`]
      const [first = '', ...rest] = lines(item, indent + 2)
      return [`${pad}- ${first.trimStart()}`, ...rest]
    })
  if (!isMapping(value)) return [pad + scalar(value)]
  return Object.entries(value).flatMap(([name, inner]) => pairLines(name, inner, indent))
}
