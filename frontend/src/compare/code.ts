// The code versions of the compared runs, as table rows. Start reading at `codeRows`.
import type { RunDetail, Versions } from '../client'

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
  { key: 'code', name: 'Code digest', digest: true, of: (flown) => flown.code },
  { key: 'loop', name: 'Simulation kernel', digest: true, of: (flown) => flown.loop },
  { key: 'simulator', name: 'Simulator digest', digest: true, of: (flown) => flown.simulator },
  { key: 'clearance', name: 'Clearance', of: (flown) => flown.clearance },
  { key: 'python', name: 'Python', of: (flown) => flown.python },
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

/** Whether runs of one campaign used different code or packages. */
export function sameCampaignOtherCode(runs: readonly Compared[]): boolean {
  const campaigns = [...new Set(runs.map((run) => run.campaign_digest))]
  return campaigns.some((campaign) =>
    codeRows(runs.filter((run) => run.campaign_digest === campaign)).some(({ key, differs }) => differs && (CODE.has(key) || /^(packages|components)\./.test(key))),
  )
}
