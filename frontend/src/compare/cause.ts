// Why the lowest values of two runs may differ: another question, another model, or only another search.
import type { CodeChanges } from '../client'
import { namesOf } from '../trends/code'
import type { Row } from './differences'

/** Groups of settings that decide which cases there are, and what value each has. */
const ASKED = ['Scenario', 'Simulator', 'Uncertain parameters', 'Criterion']
/** Settings of these groups that change the value of no case: how often cases are drawn, and what is stated of a value. */
const UNASKED = /\.distribution(\.|$)|^(correlations|objectives|criterion\.(threshold|requirements))(\.|$)/
const BOUNDS = /^uncertain\.(.*)\.(low|high)$/

/** What differs in the question, as clauses; empty if both runs have the same, apart from the threshold. */
export function otherQuestion(rows: readonly Row[]): string[] {
  const varied = new Set(rows.flatMap(({ path, values }) => (values.includes(undefined) ? [] : (BOUNDS.exec(path)?.[1] ?? []))))
  // The nominal value of a parameter that both vary is only one of its values.
  const other = rows.filter(({ path, group, differs }) => differs && ASKED.includes(group) && !UNASKED.test(path) && !varied.has(path))
  const bounds = [...new Set(other.flatMap(({ path }) => BOUNDS.exec(path)?.[1] ?? []))]
  const rest = other.map(({ path }) => path).filter((path) => !path.startsWith('uncertain.'))
  return [...(bounds.length > 0 ? [`the bounds of ${namesOf(bounds)}`] : []), ...(rest.length > 0 ? [namesOf(rest)] : [])]
}

/** The question and the code of two runs, compared. */
export interface Cause {
  /** See `otherQuestion`. */
  question: string[]
  /** Undefined until it is loaded, or if it cannot be. */
  code: Pick<CodeChanges, 'same_model' | 'same_question' | 'unidentified'> | undefined
}

/** What the runs differ in, or that only the search did; empty if that is not known. higher: the value of B. */
export function causeText({ question, code }: Cause, higher: boolean): string {
  const differing = [...question, ...(code?.same_model === false ? ['the code of the model'] : [])]
  if (differing.length > 0) return `The runs differ in: ${differing.join('; ')}.`
  if (!code || code.same_question === false) return ''
  const same = code.unidentified.length > 0 ? 'The question is the same, and the model as far as it is identified' : 'Question and model are the same'
  return `${same}: the search of B ${higher ? 'did not find the lower value of A' : 'found a lower value than that of A'}.`
}
