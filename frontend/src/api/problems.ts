// Error responses of the service as RFC 9457 problem documents, and their display.

import type { ProblemError } from '../client'

export type FieldProblem = ProblemError

/** A clause with a capital letter, unless it begins with a name, such as that of a file or `vehicle.m`. */
export const capital = (clause: string): string => (/^[a-z]+[ ,:;]/.test(clause) ? clause.charAt(0).toUpperCase() + clause.slice(1) : clause)

/** A detail of the service as a sentence. */
export function statement(detail: string): string {
  const text = capital(detail)
  return /[.!?…]$/.test(text) ? text : `${text}.`
}

/** What the service or the page refuses; its message is a sentence that pages can show as it is. */
export class Refusal extends Error {
  readonly status: number
  readonly title: string
  readonly errors: FieldProblem[]

  constructor(status: number, title: string, detail: string, errors: FieldProblem[] = []) {
    super(statement(detail || title))
    this.name = 'Refusal'
    this.status = status
    this.title = title
    this.errors = errors
  }
}

/** Whether a proxy answers in place of the service, whose own answers of these numbers are problem documents. */
export const isOfProxy = ({ status, headers }: Response): boolean =>
  [502, 503, 504].includes(status) && !headers.get('Content-Type')?.startsWith('application/problem+json')

/** Converts whatever the client caught to a problem. */
export function refusalOf(error: unknown, response: Response | undefined): Refusal {
  if (error instanceof Refusal) return error
  if (!response) return new Refusal(0, 'The service cannot be reached', 'No response from this address. Start the service on its machine with clearance serve.')
  if (isOfProxy(response))
    return new Refusal(response.status, 'Not available at the moment', `The service does not answer: a proxy in between says ${response.status}. Try again in a moment.`)
  const body = (typeof error === 'object' && error !== null ? error : {}) as Partial<Record<string, unknown>>
  const errors = Array.isArray(body.errors) ? (body.errors as FieldProblem[]) : []
  const title = typeof body.title === 'string' ? body.title : `Answer ${response.status}`
  return new Refusal(response.status, title, typeof body.detail === 'string' ? body.detail : '', errors)
}
