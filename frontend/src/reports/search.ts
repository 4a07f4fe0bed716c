// The state of the reports page in the address.

export interface ReportsSearch {
  q?: string
}

export function readReports({ q }: Record<string, unknown>): ReportsSearch {
  return typeof q === 'string' && q ? { q: q.slice(0, 200) } : {}
}
