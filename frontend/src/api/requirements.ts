// The requests of the page of requirements.
import { queryOptions } from '@tanstack/react-query'
import type { Imported, RequirementFileOut } from '../client'
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

export interface RequirementImport {
  file: File
  idAttribute: string
  textAttribute: string
}

/** Sends a file as it is. */
export const importFile = ({ file, idAttribute, textAttribute }: RequirementImport): Promise<Imported> =>
  sdk.importRequirements({ body: file, query: { name: file.name, kind: kindOf(file.name), id_attribute: idAttribute, text_attribute: textAttribute } })

/** What a file is, by its name. */
export const kindOf = (name: string): 'csv' | 'reqif' => (/\.(reqifz?|xml)$/i.test(name) ? 'reqif' : 'csv')

const matching = (etag: string | undefined) => (etag === undefined ? {} : { headers: { 'If-Match': etag } })
/** etag: of the text that was read; another one is not overwritten. */
export const writeRequirement = (id: string, text: string, etag?: string) =>
  sdk.writeRequirement({ body: { id, text }, ...matching(etag) })
export const deleteRequirement = (requirement: string, etag?: string) =>
  sdk.deleteRequirement({ query: { requirement }, ...matching(etag) })
