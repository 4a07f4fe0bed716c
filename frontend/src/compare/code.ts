// The code versions of the compared runs, as table rows.
import type { ChangedFile, RunDetail } from '../client'
import { plain } from '../format/numbers'

type Compared = Pick<RunDetail, 'campaign_digest' | 'flown' | 'identity'>

export interface CodeRow {
  key: string
  name: string
  /** One value per run; undefined if not stored. */
  values: (string | undefined)[]
  /** Whether two stored values differ. */
  differs: boolean
  digest: boolean
}

interface Row {
  key: string
  name: string
  digest?: boolean
  of: (run: Compared) => string | null | undefined
}

const DIGESTS: Row[] = [
  { key: 'digest', name: 'Code', digest: true, of: ({ identity }) => identity?.digest },
  { key: 'engine', name: 'Engine', digest: true, of: ({ identity }) => identity?.engine },
  { key: 'loop', name: 'Compiled loop', digest: true, of: ({ identity }) => identity?.loop },
]
const MACHINE: Row[] = [
  { key: 'clearance', name: 'Clearance', of: ({ flown }) => flown?.clearance },
  { key: 'step', name: 'Step', of: ({ flown }) => (flown?.step == null ? null : `${plain(1000 * flown.step)} ms`) },
  { key: 'integrator', name: 'Integrator', of: ({ flown }) => flown?.integrator },
  { key: 'cpu', name: 'Processor', of: ({ flown }) => [flown?.cpu?.model, flown?.cpu?.target].filter(Boolean).join(', ') },
]
/** The rows that can change results: a different version of Clearance or processor alone is not different code. */
const CODE = /^(engine|loop)$|^(packages|files)\./

export function codeRows(runs: readonly Compared[]): CodeRow[] {
  const named = (of: (run: Compared) => object | undefined) => [...new Set(runs.flatMap((run) => Object.keys(of(run) ?? {})))]
  const files = named(({ identity }) => identity?.files).toSorted()
  const packages = named(({ identity }) => identity?.packages)
  const looped = runs.some(({ identity }) => identity?.loop)
  const all: Row[] = [
    ...DIGESTS.filter(({ key }) => key !== 'loop' || looped),
    ...files.map((name) => ({ key: `files.${name}`, name, digest: true, of: ({ identity }: Compared) => identity?.files[name] })),
    ...MACHINE,
    ...packages.map((name) => ({ key: `packages.${name}`, name, of: ({ identity }: Compared) => identity?.packages[name] })),
  ]
  return all.map(({ key, name, digest = false, of }) => {
    const values = runs.map((run) => of(run) || undefined)
    const known = new Set(values.filter((value) => value !== undefined))
    return { key, name, digest, values, differs: known.size > 1 }
  })
}

/** The own files that are not the same in all runs that use them. */
export function changedFiles(runs: readonly Compared[]): string[] {
  return codeRows(runs).flatMap(({ key, name, differs }) => (differs && key.startsWith('files.') ? [name] : []))
}

/** The first two runs of one campaign that used different code or packages; null if there are none. */
export function otherCode<R extends Compared>(runs: readonly R[]): [R, R] | null {
  for (const [i, a] of runs.entries())
    for (const b of runs.slice(i + 1))
      if (a.campaign_digest === b.campaign_digest && codeDiffers(a, b).length > 0) return [a, b]
  return null
}

/** The rows that can change results and differ between two runs. */
export const codeDiffers = (a: Compared, b: Compared): CodeRow[] =>
  codeRows([a, b]).filter(({ key, differs }) => differs && CODE.test(key))

/** Maximum number of files in a sentence. */
const NAMED = 4

/**
 * What differs in the code of two runs of one campaign, as a sentence; files: the source files that differ, null if they are
 * not stored, undefined if they could not be loaded.
 */
export function otherCodeText(a: Compared, b: Compared, files: readonly ChangedFile[] | null | undefined): string {
  const rows = codeDiffers(a, b).filter(({ digest }) => !digest)
  const versions = rows.map(({ name, values: [before, after] }) => `${name} ${before ?? ''} and ${after ?? ''}`)
  const known = (files ?? []).map(({ file, change }) => (change === 'changed' ? file : `${file} (${change})`))
  const changed = [...new Set([...changedFiles([a, b]), ...known])]
  const named = changed.slice(0, NAMED)
  const more = changed.length - named.length
  if (named.length > 0) versions.unshift(more > 0 ? `${named.join(', ')} and ${more} more files` : named.join(', '))
  const sources = a.identity?.engine !== b.identity?.engine && !files
  if (sources) versions.unshift(files === null ? 'source files whose names are not stored' : 'source files whose names could not be loaded')
  return `Same campaign, different code: ${versions.length > 0 ? versions.join('; ') : 'the compiled loop'}.`
}
