// What the page of requirements reads, and its files.
import { queryOptions } from '@tanstack/react-query'
import type { RequirementFileOut } from '../client'
import * as sdk from '../client'
import { at } from '../format/root'
import { paged } from './queries'

const AT = '/api/v1/requirements'

/** The exported files, made when they are opened. */
export const EXPORTS = [
  { href: at(`${AT}/export/matrix.csv`), title: 'Matrix, CSV', text: 'A line for each requirement and run' },
  { href: at(`${AT}/export/argument.gsn.yaml`), title: 'Argument, GSN (YAML)', text: 'For gsn2x: goals, evidence with claim, digest and link' },
  { href: at(`${AT}/export/requirements.reqif`), title: 'Requirements, ReqIF', text: 'All of them, with their status' },
  { href: at(`${AT}/export/requirements.csv`), title: 'Requirements, CSV', text: 'All of them, with their status' },
] as const

export const contentOf = (file: RequirementFileOut): string => at(`${AT}/files/${file.id}/content`)

export const requirementsQuery = (q: string) =>
  paged(['requirements', q], (cursor) => sdk.listRequirements({ query: { q, ...(cursor ? { cursor } : {}) } }), 0)

export const importsQuery = queryOptions({
  queryKey: ['requirement-files'],
  queryFn: () => sdk.listImports(),
  staleTime: 0,
})

/** What a file is, by its name. */
export const kindOf = (name: string): 'csv' | 'reqif' => (/\.(reqifz?|xml)$/i.test(name) ? 'reqif' : 'csv')
