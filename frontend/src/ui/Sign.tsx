// Renders a symbol as in print: italic letter, upright subscript, so that "K_p1" reads K with index p1.
import { clsx } from 'clsx'
import { Fragment } from 'react'
import { apart } from '../format/names'
import { layout } from './styles'

const GREEK: Record<string, string> = {
  alpha: 'α',
  beta: 'β',
  gamma: 'γ',
  delta: 'δ',
  epsilon: 'ε',
  zeta: 'ζ',
  eta: 'η',
  theta: 'θ',
  kappa: 'κ',
  lambda: 'λ',
  mu: 'μ',
  nu: 'ν',
  xi: 'ξ',
  rho: 'ρ',
  sigma: 'σ',
  tau: 'τ',
  phi: 'φ',
  chi: 'χ',
  psi: 'ψ',
  omega: 'ω',
}

const greek = (text: string): string => text.replace(/[a-z]+/g, (word) => GREEK[word] ?? word)

/** Whether a label is a parameter path, which is shown unchanged; symbols contain no dot. */
export const isPath = (text: string): boolean => text.includes('.')

/** Base and index of a symbol. */
export function split(text: string): [string, string] {
  const at = text.indexOf('_')
  if (at < 1) return [greek(text), '']
  return [greek(text.slice(0, at)), greek(text.slice(at + 1).replace(/[{}]/g, ''))]
}

/** The symbol as plain text, for canvases, labels and files. */
export function symbolText(text: string): string {
  if (isPath(text)) return text
  const [symbol, part] = apart(text)
  return split(symbol).filter(Boolean).join('_') + part
}

/** `path` is the parameter's path, shown on hover. */
export function Sign({ text, path }: { text: string; path?: string }) {
  if (isPath(text)) return <Path text={text} />
  const [symbol, part] = apart(text)
  const [base, index] = split(symbol)
  const sign = (
    <span className="nw" title={path}>
      <i>{base}</i>
      {index && <sub>{index}</sub>}
    </span>
  )
  if (!part) return sign
  return (
    <span title={path}>
      {sign}
      {part}
    </span>
  )
}

/** A path with line-break opportunities after its dots. */
function Path({ text }: { text: string }) {
  return (
    <span className={clsx('m', layout.wrapAny)} title={text}>
      {text.split('.').map((name, i) => (
        <Fragment key={i}>
          {i > 0 && (
            <>
              .<wbr />
            </>
          )}
          {name}
        </Fragment>
      ))}
    </span>
  )
}

/** A symbol inside an SVG text. */
export function SvgSign({ text }: { text: string }) {
  if (isPath(text)) return <tspan>{text}</tspan>
  const [symbol, part] = apart(text)
  const [base, index] = split(symbol)
  return (
    <>
      <tspan fontStyle="italic">{base}</tspan>
      {index && (
        <>
          <tspan fontSize="0.8em" dy="0.28em">
            {index}
          </tspan>
          {/* An empty span cannot move the line back up: a space of no width can. */}
          <tspan dy="-0.22em">{'\u200b'}</tspan>
        </>
      )}
      {part && <tspan>{part}</tspan>}
    </>
  )
}
