// The layout of the help pages: table of contents and content.
import { clsx } from 'clsx'
import { Link } from '@tanstack/react-router'
import { type ReactElement, type ReactNode, useEffect } from 'react'
import { Failed, Loading } from '../page/Trouble'
import { Card, type CardProps } from '../ui/Card'
import { GUIDES } from './guides'
import { cards, guide, layout, prose } from '../ui/styles'
import styles from './help.module.css'

interface Chapter {
  title: string
  entries: readonly { id: string; name: ReactNode }[]
}

const TOPICS = [
  { to: '/help', name: 'Verdicts' },
  { to: '/help/evidence', name: 'What a verdict rests on' },
  { to: '/help/methods', name: 'Search methods' },
  { to: '/help/components', name: 'Components' },
  { to: '/docs', name: 'API' },
] as const

interface HelpFrameProps {
  title: string
  lede: ReactNode
  contents: readonly Chapter[]
  children: ReactNode
}

export function HelpFrame({ title, lede, contents, children }: HelpFrameProps) {
  return (
    <div className={guide.doc}>
      <nav className={guide.toc} aria-label="Help">
        <Links title="Help">
          {TOPICS.map((topic) => (
            <Link key={topic.to} to={topic.to} activeOptions={{ exact: true }} activeProps={{ 'aria-current': 'page' }}>
              {topic.name}
            </Link>
          ))}
        </Links>
        <Links title="Guides">
          {GUIDES.filter(({ name }) => name !== 'index').map(({ name, title }) => (
            <Link key={name} to="/help/guides/$name" params={{ name }} activeProps={{ 'aria-current': 'page' }}>
              {title}
            </Link>
          ))}
        </Links>
        <Contents of={contents} />
      </nav>
      <div className={guide.docbody} data-text>
        <div>
          <h1>{title}</h1>
          <p className={clsx('sec', styles.lede)}>{lede}</p>
        </div>
        {children}
        {contents.length > 0 && <Landing />}
      </div>
    </div>
  )
}

/** Beside what is loaded later, such as the catalogue: shows the section that the address names as soon as that is there. */
export function Landing() {
  useEffect(() => {
    if (location.hash) document.getElementById(decodeURIComponent(location.hash.slice(1)))?.scrollIntoView()
  }, [])
  return null
}

/** The sections of a page as links. */
export const Contents = ({ of }: { of: readonly Chapter[] }) =>
  of.map(({ title, entries }) => (
    <Links key={title} title={title}>
      {entries.map(({ id, name }) => (
        <a key={id} href={`#${id}`}>{name}</a>
      ))}
    </Links>
  ))

interface Shown extends Chapter {
  /** Next to the heading of the chapter. */
  note?: string
  entries: readonly (Chapter['entries'][number] & Pick<CardProps, 'title' | 'note' | 'right'> & { text: ReactNode })[]
}

/** Chapters of a catalogue: each entry is a card with its text. */
export const Chapters = ({ of }: { of: readonly Shown[] }) =>
  of.map(({ title: heading, note, entries }) => (
    <section key={heading} className={layout.stack}>
      <h2 className={layout.sect}>
        {heading} {note && <span className="small mut">{note}</span>}
      </h2>
      {entries.map(({ text, ...card }) => (
        <Card key={card.id} inner {...card}>
          <div className={layout.stack}>{text}</div>
        </Card>
      ))}
    </section>
  ))

const Links = ({ title, children }: { title: string; children: ReactElement[] }) => (
  <section>
    <h2 className="m mut small">{title}</h2>
    <ul>
      {children.map((link) => (
        <li key={link.key}>{link}</li>
      ))}
    </ul>
  </section>
)

/** A text with its heading. */
export const Passage = ({ id, title, children }: { id: string; title: ReactNode; children: ReactNode }) => (
  <section className={cards.card} id={id}>
    <div className={clsx(cards.bd, prose.md)}>
      <h2>{title}</h2>
      {children}
    </div>
  </section>
)

/** Words with what they mean; a name of a file as it is in files. */
export const Terms = ({ of }: { of: readonly { word: string; mono?: boolean; text: ReactNode }[] }) => (
  <dl className={styles.terms}>
    {of.map(({ word, mono, text }) => (
      <div key={word}>
        <dt className={mono ? 'mono b' : 'b'}>{word}</dt>
        <dd className="sec">{text}</dd>
      </div>
    ))}
  </dl>
)

interface UnreadProps {
  what: string
  query: { error: Error | null; failureReason: Error | null; refetch: () => unknown }
}

/** In place of what has not arrived: the rest of the help stays readable. */
export function Unread({ what, query: { error, failureReason, refetch } }: UnreadProps) {
  if (!error) return <Loading what={what} failed={failureReason} />
  return (
    <Card>
      <Failed error={error} retry={() => void refetch()} />
    </Card>
  )
}
