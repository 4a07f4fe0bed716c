// The code versions of the compared runs, as table rows.
import type { ChangedFile, RunDetail, Versions } from '../client'
import { plain } from '../format/numbers'

type Compared = Pick<RunDetail, 'campaign_digest' | 'flown'>

export interface CodeRow {
  key: string
  name: string
  /** One value per run; undefined if not stored. */
  values: (string | undefined)[]
  /** Whether two stored values differ. */
  differs: boolean
  digest: boolean
}

const ROWS: { key: string; name: string; digest?: boolean; of: (flown: Versions) => string | null | undefined }[] = [
  { key: 'code', name: 'Source digest', digest: true, of: (flown) => flown.code },
  { key: 'loop', name: 'Loop digest', digest: true, of: (flown) => flown.loop },
  { key: 'simulator', name: 'Simulator digest', digest: true, of: (flown) => flown.simulator },
  { key: 'clearance', name: 'Clearance', of: (flown) => flown.clearance },
  { key: 'python', name: 'Python', of: (flown) => flown.python },
  { key: 'step', name: 'Step', of: (flown) => (flown.step == null ? null : `${plain(1000 * flown.step)} ms`) },
  { key: 'integrator', name: 'Integrator', of: (flown) => flown.integrator },
  { key: 'cpu', name: 'Processor', of: (flown) => [flown.cpu?.model, flown.cpu?.target].filter(Boolean).join(', ') },
]
/** The rows that can change results: a different version of Clearance or processor alone is not different code. */
const CODE = new Set(['code', 'loop', 'simulator', 'python'])

export function codeRows(runs: readonly Compared[]): CodeRow[] {
  const flown = runs.map((run) => run.flown ?? null)
  const packages = [...new Set(flown.flatMap((one) => Object.keys(one?.packages ?? {})))]
  const components = [...new Set(flown.flatMap((one) => Object.keys(one?.components ?? {})))].toSorted()
  const simulated = flown.filter((one) => one?.simulator).length
  const meant = { loop: simulated < flown.length, simulator: simulated > 0 }
  const all = [
    ...ROWS.filter(({ key }) => !(key in meant) || meant[key as keyof typeof meant]),
    ...components.map((name) => ({ key: `components.${name}`, name: `components/${name}`, digest: true, of: (one: Versions) => one.components?.[name] })),
    ...packages.map((name) => ({ key: `packages.${name}`, name, digest: false, of: (one: Versions) => one.packages?.[name] })),
  ]
  return all.map(({ key, name, digest = false, of }) => {
    const values = flown.map((one) => (one ? of(one) || undefined : undefined))
    const known = new Set(values.filter((value) => value !== undefined))
    return { key, name, digest, values, differs: known.size > 1 }
  })
}

/** The operator's own components that are not the same in all runs that use them. */
export function changedComponents(runs: readonly Compared[]): string[] {
  return codeRows(runs).flatMap(({ key, name, differs }) => (differs && key.startsWith('components.') ? [name] : []))
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
  codeRows([a, b]).filter(({ key, differs }) => differs && (CODE.has(key) || /^(packages|components)\./.test(key)))

/** Maximum number of files in a sentence. */
const NAMED = 4

/** What differs in the code of two runs of one campaign, as a sentence; files: the source files that differ, if stored. */
export function otherCodeText(a: Compared, b: Compared, files: readonly ChangedFile[] | null): string {
  const rows = codeDiffers(a, b).filter(({ digest }) => !digest)
  const versions = rows.map(({ name, values: [before, after] }) => `${name} ${before ?? ''} and ${after ?? ''}`)
  const known = (files ?? []).map(({ file, change }) => (change === 'changed' ? file : `${file} (${change})`))
  const changed = [...changedComponents([a, b]), ...known]
  const named = changed.slice(0, NAMED)
  const more = changed.length - named.length
  if (named.length > 0) versions.unshift(more > 0 ? `${named.join(', ')} and ${more} more files` : named.join(', '))
  const sources = a.flown?.code !== b.flown?.code && named.length === 0
  if (sources) versions.unshift('source files whose names are not stored')
  return `Same campaign, different code: ${versions.length > 0 ? versions.join('; ') : 'the compiled loop'}.`
}
