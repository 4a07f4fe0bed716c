// A guide from the folder `docs`, bundled at build time.
import { getRouteApi, Link } from '@tanstack/react-router'
import { later, Part } from '../page/later'
import { NotFound } from '../page/Trouble'
import { useTitle } from '../page/useTitle'
import { fragmentOf, GUIDES, parts, sectionsOf, shown } from './guides'
import { HelpFrame, Landing } from './HelpFrame'
import { TEXTS } from './texts'
import { Card } from '../ui/Card'

const PICTURES = import.meta.glob<string>('../../../docs/images/*.svg', { query: '?url', import: 'default', eager: true })

// The Markdown parser is loaded on demand, as for the notes of a run.
const Markdown = later(() => import('../ui/Markdown'), 'Markdown')

const ALL = (
  <Link to="/help/guides/$name" params={{ name: 'index' }}>
    All guides
  </Link>
)

const route = getRouteApi('/help/guides/$name')

export function GuidePage() {
  const { name } = route.useParams()
  const guide = GUIDES.find((one) => one.name === name)
  useTitle(guide?.title ?? 'Guide')
  const text = TEXTS[`../../../docs/${name}.md`]
  if (!guide || text === undefined) return <NotFound />
  return (
    <HelpFrame
      title={guide.title}
      lede={guide.name === 'index' ? 'How to use, extend and operate Clearance.' : ALL}
      contents={sectionsOf(text)}
    >
      <Card>
        <Part>
          {parts(shown(text)).map((part, i) =>
            typeof part === 'string' ? (
              <Markdown key={i} text={part} idOf={fragmentOf} />
            ) : (
              <img key={i} src={PICTURES[`../../../docs/images/${part.file}`]} alt={part.alt} style={{ maxWidth: '100%' }} />
            ),
          )}
          <Landing key={guide.name} />
        </Part>
      </Card>
    </HelpFrame>
  )
}
