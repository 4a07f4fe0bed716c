// The colours and marker of every search method, from the catalogue. Those of the shipped methods are built in; a loaded
// catalogue adds those of other packages. Each method has a CSS variable of its own.
import { upperFirst } from '@mantine/hooks'
import type { Catalogue, MethodEntry } from '../client'
import shipped from '../generated/methods.json'
import { storeOf } from './store'

export type Shape = NonNullable<MethodEntry['look']>['marker']

export interface MethodLook {
  /** The CSS variable of the colour. */
  colour: string
  /** Its values in both themes, light and dark; null for the grey of a stage that does not search. */
  colours: readonly [string, string] | null
  shape: Shape
  title: string
  short: string
}

type Lookup = (name: string | null | undefined) => MethodLook
type Declared = Pick<MethodEntry, 'name' | 'title' | 'look'> & { earlier?: readonly string[] }

const NO_LOOK = { colour: '--c-nom', colours: null, shape: 'ring' } as const

const lookOf = ({ name, title, look }: Declared): MethodLook => ({
  ...(look
    ? { colour: `--m-${name.replaceAll(/\W/g, '-')}`, colours: [look.colour, look.dark] as const, shape: look.marker }
    : NO_LOOK),
  title,
  short: look?.short || title,
})

const lookupIn =
  (known: ReadonlyMap<string, MethodLook>): Lookup =>
  (name) => {
    if (name && !current.has(name)) missed(name)
    const title = upperFirst((name ?? '').replaceAll('_', ' '))
    return known.get(name ?? '') ?? { ...NO_LOOK, title, short: title }
  }

const byName = (methods: readonly Declared[]) =>
  methods.flatMap((method) => [method.name, ...(method.earlier ?? [])].map((name) => [name, lookOf(method)] as const))

/** The variables of all colours; a sheet of the document's own needs no inline style, which the policy forbids. */
export function variables(looks: readonly MethodLook[]): string {
  const of = (theme: 0 | 1) =>
    looks.map(({ colour, colours }) => (colours ? `${colour}: ${colours[theme]};` : '')).join(' ')
  return `:root { ${of(0)} } :root[data-theme="dark"] { ${of(1)} }`
}

let sheet: CSSStyleSheet | null = null

function paint(): void {
  if (typeof document === 'undefined' || !('adoptedStyleSheets' in document)) return
  if (!sheet) document.adoptedStyleSheets = [...document.adoptedStyleSheets, (sheet = new CSSStyleSheet())]
  sheet.replaceSync(variables([...known.values()]))
}

const SHIPPED = shipped as readonly Declared[]
/** The methods whose look is that of today, and those for which the catalogue has been requested. */
const current = new Set(SHIPPED.flatMap(({ name, earlier = [] }) => [name, ...earlier]))
let request: (() => unknown) | null = null

/** Requests the catalogue after the rendering that shows a method of another package: most pages show none. */
function missed(name: string): void {
  current.add(name)
  if (request) queueMicrotask(request)
}

/** How the catalogue is requested. */
export function requestBy(call: () => unknown): void {
  request = call
}

let known: ReadonlyMap<string, MethodLook> = new Map(byName(SHIPPED))
const lookup = storeOf(lookupIn(known))
paint()

/**
 * Takes in the methods of a catalogue. One without a look keeps the look that is known of it; what a run kept adds only
 * methods that are not known, as a method has its colour of today in every run.
 */
export function learnMethods(catalogue: Catalogue, kept = false): Catalogue {
  const news = byName(catalogue.methods.filter(({ name, look }) => (look && !kept) || !known.has(name)))
  const before = known
  if (!kept) for (const { name } of catalogue.methods) current.add(name)
  if (news.some(([name, look]) => JSON.stringify(before.get(name)) !== JSON.stringify(look))) {
    known = new Map([...known, ...news])
    paint()
    lookup.set(lookupIn(known))
  }
  return catalogue
}

/** The look of a method; a stage that is not a search has a grey ring. */
export const methodLook: Lookup = (name) => lookup.get()(name)

/** `methodLook` as a hook, which renders again when a catalogue adds methods. */
export const useMethodLook = lookup.useValue

/** The outline of a marker in a box of 10 by 10, as SVG path data. */
export const OUTLINE: Record<Shape, string> = {
  square: 'M1.5 1.5h7v7h-7z',
  diamond: 'M5 .4 9.6 5 5 9.6.4 5z',
  triangle: 'M5 .8 9.6 8.9H.4z',
  circle: 'M5 1a4 4 0 1 0 0 8a4 4 0 1 0 0-8z',
  hexagon: 'M2.7 1h4.6L9.6 5 7.3 9H2.7L.4 5z',
  pentagon: 'M5 .4 9.6 3.8 7.9 9.1H2.1L.4 3.8z',
  down: 'M5 9.2.4 1.1h9.2z',
  right: 'M9.2 5 1.1.4v9.2z',
  left: 'M.8 5 8.9.4v9.2z',
  hourglass: 'M.9.7v8.6L5 5.9l4.1 3.4V.7L5 4.1z',
  shield: 'M1 .9h8v4.4L5 9.4 1 5.3z',
  star: 'M5 0l1.4 3.3 3.6.3-2.7 2.4.8 3.5L5 7.7 1.9 9.5l.8-3.5L0 3.6l3.6-.3z',
  plus: 'M3.5.7h3v2.8h2.8v3H6.5v2.8h-3V6.5H.7v-3h2.8z',
  bow: 'M.7.9h8.6L5.9 5l3.4 4.1H.7L4.1 5z',
  box: 'M1.7 1.7h6.6v6.6H1.7z',
  asterisk: 'M5 .5v9M1.1 2.75l7.8 4.5M8.9 2.75l-7.8 4.5',
  cross: 'M1.8 1.8l6.4 6.4M8.2 1.8l-6.4 6.4',
  ring: 'M5 1.5a3.5 3.5 0 1 0 0 7a3.5 3.5 0 1 0 0-7z',
}

const OPEN: readonly Shape[] = ['cross', 'ring', 'box', 'asterisk']

export const isOpen = (shape: Shape): boolean => OPEN.includes(shape)
