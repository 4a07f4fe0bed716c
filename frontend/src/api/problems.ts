// Error responses of the service as RFC 9457 problem documents, and their display.

export interface FieldProblem {
  field: string
  given: string
  message: string
}

export class Refusal extends Error {
  readonly status: number
  readonly title: string
  readonly errors: FieldProblem[]

  constructor(status: number, title: string, detail: string, errors: FieldProblem[] = []) {
    super(detail || title)
    this.name = 'Refusal'
    this.status = status
    this.title = title
    this.errors = errors
  }
}

/** Converts whatever the client caught to a problem. */
export function refusalOf(error: unknown, response: Response | undefined): Refusal {
  if (error instanceof Refusal) return error
  if (!response) return new Refusal(0, 'The service cannot be reached', 'No response from this address. Start the service on its machine with clearance serve.')
  const body = (typeof error === 'object' && error !== null ? error : {}) as Partial<Record<string, unknown>>
  const errors = Array.isArray(body.errors) ? (body.errors as FieldProblem[]) : []
  const title = typeof body.title === 'string' ? body.title : `Answer ${response.status}`
  return new Refusal(response.status, title, typeof body.detail === 'string' ? body.detail : '', errors)
}
