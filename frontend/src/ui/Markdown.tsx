// Markdown as elements: the text is parsed, never inserted as HTML, so that it cannot contain a script. Images
// are not loaded and HTML is shown as text. Source of the syntax: GitHub Flavored Markdown. Start: `Markdown`.
import { clsx } from 'clsx'
import { marked, type Token, type Tokens } from 'marked'
import { Fragment, type ReactNode, useMemo } from 'react'
import { at } from '../format/root'
import { fields, layout, prose, tables } from './styles'
import styles from './ui.module.css'

interface MarkdownProps {
  text: string
  /** Of a text that is the page itself, whose own heading is h1: the fragment of a heading. */
  idOf?: (heading: string) => string
}

export function Markdown({ text, idOf }: MarkdownProps) {
  const tokens = useMemo(() => marked.lexer(text, { gfm: true, breaks: false }), [text])
  return <div className={clsx(prose.md, idOf && prose.page)}>{blocks(tokens, idOf)}</div>
}

const blocks = (tokens: readonly Token[], idOf?: MarkdownProps['idOf']): ReactNode =>
  tokens.map((token, i) => <Fragment key={i}>{block(token, idOf)}</Fragment>)

function block(token: Token, idOf?: MarkdownProps['idOf']): ReactNode {
  switch (token.type) {
    case 'heading': {
      const { depth, text } = token as Tokens.Heading
      // Of a text within a page, whose own headings are h1 and h2, the first one is h3.
      const Heading = (['h1', 'h2', 'h3', 'h4', 'h5', 'h6'] as const)[Math.min(5, depth - 1 + (idOf ? 0 : 2))] ?? 'h6'
      return <Heading id={idOf?.(text)}>{inlines(token)}</Heading>
    }
    case 'paragraph':
      return <p>{inlines(token)}</p>
    case 'text':
      return inlines(token)
    case 'blockquote':
      return <blockquote>{blocks(token.tokens ?? [])}</blockquote>
    case 'code':
      return (
        // It scrolls in a narrow window, so the keyboard must reach it.
        <pre tabIndex={0}>
          <code>{(token as Tokens.Code).text}</code>
        </pre>
      )
    case 'list':
      return list(token as Tokens.List)
    case 'table':
      return table(token as Tokens.Table)
    case 'hr':
      return <hr />
    case 'space':
    case 'def':
      return null
    default:
      return <p>{token.raw}</p>
  }
}

function list({ ordered, start, items }: Tokens.List): ReactNode {
  const shown = items.map((item, i) => (
    <li key={i} className={item.task ? styles.task : undefined}>
      {item.task && <input className={fields.check} type="checkbox" checked={item.checked} readOnly disabled aria-label="Task" />}
      {blocks(item.tokens.filter((token) => token.type !== 'checkbox'))}
    </li>
  ))
  return ordered ? <ol start={start === '' ? 1 : start}>{shown}</ol> : <ul>{shown}</ul>
}

function table({ header, rows, align }: Tokens.Table): ReactNode {
  const side = (i: number) => ({ textAlign: align[i] ?? undefined })
  return (
    <div className={layout.scrollx} tabIndex={0} role="region" aria-label="Table">
      <table className={clsx(tables.table, tables.tight)}>
        <thead>
          <tr>
            {header.map((cell, i) => (
              <th key={i} style={side(i)}>
                {inlines(cell)}
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          {rows.map((row, j) => (
            <tr key={j}>
              {row.map((cell, i) => (
                <td key={i} style={side(i)}>
                  {inlines(cell)}
                </td>
              ))}
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  )
}

function inlines(of: { tokens?: readonly Token[]; text?: string }): ReactNode {
  if (!of.tokens) return entities(of.text ?? '')
  return of.tokens.map((token, i) => <Fragment key={i}>{inline(token)}</Fragment>)
}

function inline(token: Token): ReactNode {
  switch (token.type) {
    case 'text':
      return token.tokens ? inlines(token) : entities((token as Tokens.Text).text)
    case 'escape':
      return (token as Tokens.Escape).text
    case 'strong':
      return <strong>{inlines(token)}</strong>
    case 'em':
      return <em>{inlines(token)}</em>
    case 'del':
      return <del>{inlines(token)}</del>
    case 'codespan':
      return <code>{(token as Tokens.Codespan).text}</code>
    case 'br':
      return <br />
    case 'link':
      return link(token as Tokens.Link)
    default:
      return token.raw
  }
}

/** Only web addresses and those of this service; anything else, such as a script, stays text. */
export const isSafe = (href: string): boolean => /^(https?:\/\/|mailto:|\/(?!\/)|#)/i.test(href)

function link(token: Tokens.Link): ReactNode {
  if (!isSafe(token.href)) return token.raw
  return (
    <a href={token.href.startsWith('/') ? at(token.href) : token.href} rel="noreferrer" target={/^(\/|#)/.test(token.href) ? undefined : '_blank'}>
      {inlines(token)}
    </a>
  )
}

const NAMED: Record<string, string> = { amp: '&', lt: '<', gt: '>', quot: '"', '#39': "'" }

/** The parser does not decode these entities; they are replaced by their characters. */
const entities = (text: string): string => text.replace(/&(amp|lt|gt|quot|#39);/g, (_, name: string) => NAMED[name] ?? _)
