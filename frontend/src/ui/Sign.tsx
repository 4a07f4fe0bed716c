// A symbol of the field set as in print: italic letter, upright subscript, so that "K_p1" reads K with index p1.
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

/** Base and index of a symbol's text. */
export function split(text: string): [string, string] {
  const at = text.indexOf('_')
  if (at < 1) return [greek(text), '']
  return [greek(text.slice(0, at)), greek(text.slice(at + 1).replace(/[{}]/g, ''))]
}

/** The symbol as plain text, for canvases, labels and files. */
export const symbolText = (text: string): string => split(text).filter(Boolean).join('_')

export function Sign({ text }: { text: string }) {
  const [base, index] = split(text)
  return (
    <span className="nw">
      <i className="v">{base}</i>
      {index && <sub>{index}</sub>}
    </span>
  )
}

/** The same inside an SVG text. */
export function SvgSign({ text }: { text: string }) {
  const [base, index] = split(text)
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
    </>
  )
}
