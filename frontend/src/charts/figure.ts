// Saves a chart's card as an image: PNG always, SVG if everything is drawn as SVG. Colours and fonts are those of the
// page. The image is composed of the card's parts at their positions: canvases, drawings, lines of text.
import { save } from '../ui/files'
import { colour } from './draw'

const SVG = 'http://www.w3.org/2000/svg'
const MARGIN = 16
const PROPERTIES = [
  'fill',
  'fill-opacity',
  'stroke',
  'stroke-width',
  'stroke-dasharray',
  'stroke-linecap',
  'stroke-linejoin',
  'stroke-opacity',
  'opacity',
  'font-family',
  'font-size',
  'font-style',
  'font-weight',
  'text-anchor',
  'paint-order',
]

type Box = Pick<DOMRect, 'x' | 'y' | 'width' | 'height'>

/** Whether everything in the card is drawn as SVG. */
export const isDrawing = (card: HTMLElement): boolean => !chartOf(card).querySelector('canvas')

/** The part of a card that is the chart, without its heading. */
const chartOf = (card: HTMLElement): HTMLElement => card.querySelector<HTMLElement>(':scope > [data-body]') ?? card

export async function savePng(card: HTMLElement, name: string): Promise<void> {
  const part = chartOf(card)
  const frame = part.getBoundingClientRect()
  const ratio = 2
  const canvas = document.createElement('canvas')
  canvas.width = (frame.width + 2 * MARGIN) * ratio
  canvas.height = (frame.height + 2 * MARGIN) * ratio
  const ctx = canvas.getContext('2d')
  if (!ctx) return
  ctx.scale(ratio, ratio)
  ctx.fillStyle = colour('--surface')
  ctx.fillRect(0, 0, canvas.width, canvas.height)
  for (const source of part.querySelectorAll('canvas')) {
    const box = within(source, frame)
    ctx.drawImage(source, box.x, box.y, box.width, box.height)
  }
  for (const source of shown(part)) {
    const box = within(source, frame)
    ctx.drawImage(await picture(source), box.x, box.y, box.width, box.height)
  }
  for (const line of textsOf(part)) {
    const style = getComputedStyle(line.element)
    ctx.font = `${style.fontStyle} ${style.fontWeight} ${style.fontSize} ${style.fontFamily}`
    ctx.fillStyle = style.color
    ctx.textBaseline = 'middle'
    ctx.fillText(line.text, line.box.left - frame.left + MARGIN, (line.box.top + line.box.bottom) / 2 - frame.top + MARGIN)
  }
  for (const swatch of part.querySelectorAll<HTMLElement>('[data-swatch]')) {
    const box = within(swatch, frame)
    ctx.fillStyle = getComputedStyle(swatch).borderTopColor
    ctx.fillRect(box.x, box.y + box.height / 2 - 1, box.width, 2)
  }
  const blob = await new Promise<Blob | null>((done) => canvas.toBlob(done, 'image/png'))
  if (blob) save(`${name}.png`, blob)
}

export function saveSvg(card: HTMLElement, name: string): void {
  const part = chartOf(card)
  const frame = part.getBoundingClientRect()
  const [width, height] = [frame.width + 2 * MARGIN, frame.height + 2 * MARGIN]
  const whole = element('svg', { xmlns: SVG, width, height, viewBox: `0 0 ${width} ${height}` })
  whole.append(element('rect', { width, height, fill: colour('--surface') }))
  for (const source of shown(part)) {
    const box = within(source, frame)
    const copy = styled(source)
    for (const [key, value] of Object.entries(box)) copy.setAttribute(key, String(value))
    whole.append(copy)
  }
  for (const line of textsOf(part)) {
    const style = getComputedStyle(line.element)
    const text = element('text', {
      'xml:space': 'preserve',
      x: line.box.left - frame.left + MARGIN,
      y: line.box.bottom - frame.top + MARGIN - 0.28 * line.box.height,
      fill: style.color,
      'font-family': style.fontFamily,
      'font-size': style.fontSize,
      'font-weight': style.fontWeight,
      'font-style': style.fontStyle,
    })
    text.textContent = line.text
    whole.append(text)
  }
  save(`${name}.svg`, new XMLSerializer().serializeToString(whole), 'image/svg+xml')
}

function within(source: Element, frame: DOMRect): Box {
  const box = source.getBoundingClientRect()
  return { x: box.left - frame.left + MARGIN, y: box.top - frame.top + MARGIN, width: box.width, height: box.height }
}

/** Drawings that are figures or marks, not icons of buttons. */
function shown(part: HTMLElement): SVGSVGElement[] {
  return [...part.querySelectorAll('svg')].filter((svg) => !svg.closest('[data-control]') && svg.clientWidth > 0)
}

function element(name: string, attributes: Record<string, string | number>): SVGElement {
  const made = document.createElementNS(SVG, name)
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, String(value))
  return made
}

/** A copy with inlined styles. */
function styled(source: SVGSVGElement): SVGSVGElement {
  const copy = source.cloneNode(true) as SVGSVGElement
  const originals = [source, ...source.querySelectorAll('*')]
  const copies = [copy, ...copy.querySelectorAll('*')]
  originals.forEach((original, i) => {
    const style = getComputedStyle(original)
    const target = copies[i] as SVGElement
    target.removeAttribute('class')
    target.setAttribute('style', PROPERTIES.map((name) => `${name}:${style.getPropertyValue(name)}`).join(';'))
  })
  copy.setAttribute('xmlns', SVG)
  return copy
}

async function picture(source: SVGSVGElement): Promise<HTMLImageElement> {
  const copy = styled(source)
  const box = source.getBoundingClientRect()
  copy.setAttribute('width', String(box.width * 2))
  copy.setAttribute('height', String(box.height * 2))
  if (!copy.getAttribute('viewBox')) copy.setAttribute('viewBox', `0 0 ${box.width} ${box.height}`)
  const image = new Image()
  const url = URL.createObjectURL(new Blob([new XMLSerializer().serializeToString(copy)], { type: 'image/svg+xml' }))
  image.src = url
  await image.decode()
  URL.revokeObjectURL(url)
  return image
}

interface TextLine {
  element: Element
  text: string
  box: DOMRect
}

/** The lines of text around the drawings: titles of axes, the legend. */
function textsOf(part: HTMLElement): TextLine[] {
  const found: TextLine[] = []
  const walker = document.createTreeWalker(part, NodeFilter.SHOW_TEXT)
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const parent = node.parentElement
    if (!parent || !node.textContent?.trim() || parent.closest('svg, [data-control], .sr, [data-float], table')) continue
    for (const { text, box } of linesOf(node)) found.push({ element: parent, text, box })
  }
  return found
}

/** A text node as the lines in which the page wraps it. */
function linesOf(node: Node): { text: string; box: DOMRect }[] {
  const words = (node.textContent ?? '').split(/(?<=\s)/)
  const lines: { text: string; box: DOMRect }[] = []
  let at = 0
  for (const word of words) {
    const range = document.createRange()
    range.setStart(node, at)
    range.setEnd(node, at + word.length)
    at += word.length
    const box = range.getBoundingClientRect()
    const last = lines[lines.length - 1]
    if (box.width === 0) continue
    if (last && Math.abs(last.box.top - box.top) < 2) last.text += word
    else lines.push({ text: word, box })
  }
  return lines
}
