// The API page, from the OpenAPI document: every operation with parameters, bodies and responses, and a form to try it.
import { upperFirst } from '@mantine/hooks'
import { useQuery } from '@tanstack/react-query'
import { clsx } from 'clsx'
import { getOpenApi } from '../api/calls'
import { Contents } from '../help/HelpFrame'
import { PageHead } from '../page/PageHead'
import { Unloaded } from '../page/Trouble'
import { useTitle } from '../page/useTitle'
import { ButtonAnchor } from '../ui/Button'
import { Card } from '../ui/Card'
import { CopyButton } from '../ui/files'
import { OperationCard } from './OperationCard'
import { type OpenApi, operationsOf } from './openapi'
import { at, ROOT } from '../format/root'
import { guide, layout } from '../ui/styles'
import styles from './docs.module.css'

export function ApiPage() {
  useTitle('API')
  const query = useQuery({ queryKey: ['openapi'], queryFn: getOpenApi, staleTime: Number.POSITIVE_INFINITY })
  if (!query.data) return <Unloaded query={query} what="the API" title="API" />
  return <Page document={query.data as OpenApi} />
}

function Page({ document }: { document: OpenApi }) {
  const groups = operationsOf(document)
  const access = `export CLEARANCE_SERVICE=${location.origin}${ROOT}\nexport CLEARANCE_TOKEN=…`
  const first = `${access}\ncurl -H "Authorization: Bearer $CLEARANCE_TOKEN" "$CLEARANCE_SERVICE/api/v1/runs?limit=5"`
  return (
    <div className={guide.doc}>
      <nav className={guide.toc} aria-label="Operations">
        <Contents
          of={groups.map(({ name, operations }) => ({
            title: upperFirst(name),
            entries: operations.map(({ operationId, method, path }) => ({
              id: operationId,
              name: [<Verb key="verb" of={method} />, <span key="path" className={layout.cut}>{path.replace('/api/v1', '')}</span>],
            })),
          }))}
        />
      </nav>
      <div className={guide.docbody} data-text>
        <PageHead title="API" note={`${document.info.title} ${document.info.version}. ${document.info.summary ?? ''}`}>
          <ButtonAnchor href={at('/api/v1/openapi.json')} target="_blank" rel="noreferrer">OpenAPI document</ButtonAnchor>
        </PageHead>
        <Card>
          <p>
            Programs send a token, created with <code>clearance token create NAME</code> and shown once. This page sends
            what you try as you. An error is a problem document (RFC 9457): what was given, what is allowed, what to
            do.
          </p>
          <Snippet text={first} />
          <p>
            In continuous integration one command sends a campaign, waits, and ends with the verdict: its exit code is
            0 for cleared, 1 for violated, 2 for inconclusive. <code>--out</code> keeps report, run, campaign, findings and
            evaluations.
          </p>
          <Snippet text="clearance submit campaign.yaml --tag nightly --out artefacts/" />
        </Card>
        {groups.map((group) => (
          <section key={group.name} aria-label={upperFirst(group.name)}>
            <h2 className={layout.sect}>
              {upperFirst(group.name)} <span className="small mut">{group.description}</span>
            </h2>
            <div className={layout.stack}>
              {group.operations.map((operation) => (
                <OperationCard key={operation.operationId} operation={operation} schemas={document.components.schemas} />
              ))}
            </div>
          </section>
        ))}
      </div>
    </div>
  )
}

const TONES: Readonly<Record<string, string>> = { get: 'run', post: 'ok', patch: 'ok', delete: 'bad' }

export const Verb = ({ of }: { of: string }) => <span className={styles.verb} data-tone={TONES[of]}>{of}</span>

export function Snippet({ text }: { text: string }) {
  return (
    <div className={styles.snippet}>
      <pre className={clsx('mono small', layout.grow)} tabIndex={0}>{text}</pre>
      <CopyButton text={() => text}>Copy</CopyButton>
    </div>
  )
}
