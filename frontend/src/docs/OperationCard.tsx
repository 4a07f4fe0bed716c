// One operation: parameters, body, responses; GET operations can be sent from here.
import { IconSend } from '@tabler/icons-react'
import { useMutation } from '@tanstack/react-query'
import { clsx } from 'clsx'
import { useId, useState } from 'react'
import { duration } from '../format/numbers'
import { Snippet, Verb } from './ApiPage'
import type { Schema } from '../api/schema'
import { addressOf, curlOf, limitsOf, type Operation, type Parameter, typeOf } from './openapi'
import { Shape } from './Shape'
import { Button } from '../ui/Button'
import { Card } from '../ui/Card'
import { type Column, Table } from '../ui/Table'
import { Ticked } from '../ui/Ticked'
import { ROOT } from '../format/root'
import { fields, layout } from '../ui/styles'
import styles from './docs.module.css'

export function OperationCard({ operation, schemas }: { operation: Operation; schemas: Record<string, Schema> }) {
  const { method, path, operationId, description, requestBody, responses } = operation
  const [values, setValues] = useState<Record<string, string>>({})
  const parameters = (operation.parameters ?? []).filter((parameter) => parameter.in !== 'cookie')
  const bodies = Object.entries(requestBody?.content ?? {})
  const answers = Object.entries(responses).filter(([status]) => /^2/.test(status))
  const columns: Column<Parameter>[] = [
    { head: 'Parameter', tone: 'mono', cell: ({ name, required }) => [name, required && <span key="required" className="mut"> required</span>] },
    { head: 'Type', tone: 'sec', cell: ({ schema }) => typeOf(schema) },
    { head: 'Meaning', tone: 'sec', cell: (parameter) => <Ticked text={meaningOf(parameter)} /> },
    {
      head: 'Value',
      cell: ({ name }) => (
        <input
          className={fields.cell}
          style={{ textAlign: 'left' }}
          aria-label={`${name} of ${operationId}`}
          value={values[name] ?? ''}
          onChange={(event) => setValues({ ...values, [name]: event.target.value })}
        />
      ),
    },
  ]
  return (
    <Card inner id={operationId} title={<span className="mono"><Verb of={method} /> {path}</span>}>
      <div className={clsx(layout.stack, styles.operation)}>
        <p>
          <Ticked text={description} />
        </p>
        {parameters.length > 0 && (
          <div className={layout.scrollx}>
            <Table tight className={styles.parameters} rows={parameters} by={({ name }) => name} columns={columns} />
          </div>
        )}
        {bodies.map(([type, { schema }]) => (
          <Shape key={type} title={`Body, ${type}`} schema={schema} schemas={schemas} />
        ))}
        {answers.map(([status, answer]) =>
          answer.content ? (
            Object.entries(answer.content).map(([type, { schema }]) => (
              <Shape key={status + type} title={`Response ${status}, ${type}`} schema={schema} schemas={schemas} />
            ))
          ) : (
            <p key={status} className="small sec">
              Response {status}, without a body
            </p>
          ),
        )}
        <Snippet text={curlOf(operation, location.origin + ROOT, values)} />
        {method === 'get' && !path.endsWith('/events') && <Trial operation={operation} values={values} />}
      </div>
    </Card>
  )
}

/** The session by its id · at most 64 characters */
function meaningOf({ description, schema }: Parameter): string {
  const more = [limitsOf(schema), defaultOf(schema)].filter(Boolean)
  return [more.length > 0 ? description?.replace(/\.$/, '') : description, ...more].filter(Boolean).join(' · ')
}

const defaultOf = (schema: Schema | undefined): string | null =>
  schema?.default === undefined || schema.default === '' ? null : `default ${JSON.stringify(schema.default)}`

const LONGEST = 20_000

/** Sends the request with this browser's session and shows the response. */
function Trial({ operation, values }: { operation: Operation; values: Record<string, string> }) {
  const address = addressOf(operation, values)
  const hint = useId()
  const missing = /\{\w+\}/.test(address)
  const trial = useMutation({
    mutationFn: async () => {
      const begun = performance.now()
      const answer = await fetch(address, { headers: { Accept: 'application/json' } })
      const json = /json/.test(answer.headers.get('content-type') ?? '')
      const text = json ? JSON.stringify(await answer.json(), null, 2) : await answer.text()
      return { status: answer.status, seconds: (performance.now() - begun) / 1000, text }
    },
  })
  return (
    <div className={layout.stack}>
      <div className={layout.row}>
        <Button small icon={IconSend} disabled={missing || trial.isPending} aria-describedby={missing ? hint : undefined} onClick={() => trial.mutate()}>
          Send
        </Button>
        {missing && (
          <span className="small mut" id={hint}>
            Fill in the required values first.
          </span>
        )}
        {trial.data && (
          <span className="small sec" role="status">
            {trial.data.status} in {duration(trial.data.seconds)}
          </span>
        )}
        {trial.isError && <span className={fields.ferr}>{trial.error.message}</span>}
      </div>
      {trial.data && (
        <pre className={clsx('mono', styles.answer)} tabIndex={0} aria-label="Response">
          {trial.data.text.slice(0, LONGEST)}
          {trial.data.text.length > LONGEST && '\n… truncated'}
        </pre>
      )}
    </div>
  )
}
