// The fields of a body or a response; nested types expand where they are named.
import { clsx } from 'clsx'
import type { Schema } from '../api/schema'
import { limitsOf, partsOf, typeOf } from './openapi'
import { Ticked } from '../ui/Ticked'
import styles from './docs.module.css'

interface ShapeProps {
  title: string
  schema: Schema | undefined
  schemas: Record<string, Schema>
  /** Enclosing types, which are not expanded again. */
  inside?: readonly string[]
}

export function Shape({ title, schema, schemas, inside = [] }: ShapeProps) {
  const own = schema?.properties ? [['', schema] as const] : []
  const named = partsOf(schema)
    .filter((name) => !inside.includes(name))
    .flatMap((name) => (schemas[name]?.properties ? [[name, schemas[name]] as const] : []))
  const parts = [...own, ...named]
  const label = (
    <>
      {title && `${title}: `}
      <span className="mono">{typeOf(schema)}</span>
    </>
  )
  if (parts.length === 0) return <p className="small sec">{label}</p>
  return (
    <details className={styles.shape}>
      <summary>{label}</summary>
      {parts.map(([name, part]) => (
        <Fields key={name} name={name} schema={part} schemas={schemas} inside={[...inside, name]} />
      ))}
    </details>
  )
}

interface FieldsProps {
  name: string
  schema: Schema
  schemas: Record<string, Schema>
  inside: readonly string[]
}

function Fields({ name, schema, schemas, inside }: FieldsProps) {
  const fields = Object.entries(schema.properties ?? {})
  return (
    <div>
      {name && (
        <p className="small">
          <span className="mono b">{name}</span> <span className="sec"><Ticked text={firstLine(schema.description)} /></span>
        </p>
      )}
      <dl className={clsx('small', styles.fieldlist)}>
        {fields.map(([field, of]) => {
          const opens = partsOf(of).some((part) => schemas[part]?.properties && !inside.includes(part))
          return (
            <div key={field}>
              <dt className="mono">{field}</dt>
              <dd>
                {opens ? (
                  <Shape title="" schema={of} schemas={schemas} inside={inside} />
                ) : (
                  <span className="mono">{typeOf(of)}</span>
                )}
                <span className="sec"> <Ticked text={[limitsOf(of), of.description].filter(Boolean).join(' · ')} /></span>
              </dd>
            </div>
          )
        })}
      </dl>
    </div>
  )
}

const firstLine = (text = ''): string => text.split('\n')[0] ?? ''
