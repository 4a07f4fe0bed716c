// Parses the docstring of a component or method: paragraphs, equations, tables.

export interface Part {
  kind: 'text' | 'equations' | 'table'
  /** The label that starts the paragraph, such as Source. */
  label?: string
  text: string
}

const LABEL = /^(Source|Limits|Reconstructed|Distribution|Assumptions|Note|Meant for|Measured): */
/** Addressed to readers of the code; not shown. */
const FOR_READERS = /\s*Start reading at `[^`]+`\.?/g

const isIndented = (line: string): boolean => /^ {3,}/.test(line)
/** A table: several spaces after the first column. */
const isColumns = (lines: string[]): boolean => lines.filter((line) => /^\S+ {2,}\S/.test(line)).length > 0

/** The first line (the summary), and the remaining parts. */
export function partsOf(text: string): { title: string; parts: Part[] } {
  const [title = '', ...rest] = text.replace(FOR_READERS, '').trim().split('\n')
  const blocks = rest
    .join('\n')
    .split(/\n\s*\n/)
    .map((block) => block.split('\n').filter((line) => line.trim()))
    .filter((lines) => lines.length > 0)
  return { title, parts: blocks.flatMap(partsOfBlock) }
}

function partsOfBlock(lines: string[]): Part[] {
  if (lines.every(isIndented)) return [{ kind: 'equations', text: dedented(lines) }]
  if (isColumns(lines)) return [{ kind: 'table', text: lines.join('\n') }]
  const parts: Part[] = []
  for (const line of lines) {
    const label = LABEL.exec(line)
    const last = parts[parts.length - 1]
    if (label) parts.push({ kind: 'text', label: label[1], text: line.slice(label[0].length) })
    else if (isIndented(line)) {
      if (last?.kind === 'equations') last.text += `\n${line.trim()}`
      else parts.push({ kind: 'equations', text: line.trim() })
    } else if (last?.kind === 'text') last.text += ` ${line.trim()}`
    else parts.push({ kind: 'text', text: line.trim() })
  }
  return parts
}

function dedented(lines: string[]): string {
  const least = Math.min(...lines.map((line) => line.length - line.trimStart().length))
  return lines.map((line) => line.slice(least).trimEnd()).join('\n')
}
