// Provenance: everything needed to reproduce the numbers, and the campaign as a file.
import { resultWith } from '../../api/stages'
import { IconDownload } from '@tabler/icons-react'
import { useMutation } from '@tanstack/react-query'
import { Link } from '@tanstack/react-router'
import type { ReactNode } from 'react'
import { getRunText } from '../../api/calls'
import type { Identity, Provenance as Origin, RunDetail, Versions } from '../../client'
import { plain } from '../../format/numbers'
import { launchedBy } from '../../format/people'
import { moment } from '../../format/time'
import { idOfComponent } from '../../help/links'
import { unreadOf } from '../../trends/code'
import { Button } from '../../ui/Button'
import { Card } from '../../ui/Card'
import { CopyButton, save } from '../../ui/files'
import type { RunData } from '../data/data'
import { layout, lists } from '../../ui/styles'
import styles from './provenance.module.css'

export function Provenance({ data }: { data: RunData }) {
  const { run } = data
  const origin = originOf(run)
  const download = useMutation({
    mutationFn: () => getRunText(run.id),
    onSuccess: (text) => save(`${run.id}-campaign.yaml`, text, 'application/yaml'),
  })
  const all = {
    run: run.id,
    campaign_digest: run.campaign_digest,
    ...origin,
    identity: run.identity,
    undigested: run.undigested,
    worker: run.worker,
    started: run.started,
    finished: run.finished,
  }
  return (
    <Card
      title="Provenance"
      note="What is needed to reproduce the numbers"
      className={layout.c12}
      id="provenance"
      right={
        <>
          <CopyButton text={() => JSON.stringify(all, null, 2)}>Copy as JSON</CopyButton>
          <Button small icon={IconDownload} onClick={() => download.mutate()} disabled={download.isPending}>
            Campaign file
          </Button>
        </>
      }
    >
      <div className={styles.prov}>
        <List rows={flightRows(data, origin)} />
        <List rows={machineRows(data, origin)} />
      </div>
    </Card>
  )
}

/** The provenance of the verdict; missing values, and those of a run without a verdict, are from the start of the run. */
export function originOf({ summary, flown }: Pick<RunDetail, 'summary' | 'flown'>): Origin {
  const stated = summary?.provenance
  const known = <K extends keyof Versions>(key: K): Versions[K] | null => stated?.[key] ?? flown?.[key] ?? null
  return {
    digest: stated?.digest ?? null,
    seed: stated?.seed ?? null,
    clearance: known('clearance'),
    python: known('python'),
    packages: { ...flown?.packages, ...stated?.packages },
    system: known('system'),
    cpu: known('cpu'),
    code: known('code'),
    loop: known('loop'),
    lanes: known('lanes'),
    step: known('step'),
    integrator: known('integrator'),
    simulator: stated?.simulator ?? flown?.simulator ?? null,
    evaluator: stated?.evaluator ?? flown?.evaluator ?? null,
  }
}

type Rows = [string, ReactNode][]

function List({ rows }: { rows: Rows }) {
  return (
    <dl className={lists.kv}>
      {rows.map(([name, value]) => (
        <div key={name} style={{ display: 'contents' }}>
          <dt>{name}</dt>
          <dd>{value}</dd>
        </div>
      ))}
    </dl>
  )
}

const hash = (text: string | null | undefined) => (
  <span className="mono" title={text ?? undefined}>
    {text ? text.slice(0, 16) : 'not recorded'}
  </span>
)

const mono = (version: string | null) => <span className="mono">{version ?? 'not recorded'}</span>

function flightRows(data: RunData, origin: Origin): Rows {
  const { run, campaign } = data
  return [
    ['Campaign', <span key="c">sha256 {hash(run.campaign_digest)}</span>],
    ...codeRows(run.identity),
    ...(run.undigested ? ([['Begun', run.undigested]] as Rows) : []),
    ['Seed', String(origin.seed ?? campaign.seed ?? '')],
    ['Sample seed', sampleSeed(data)],
    ...(campaign.simulator ? [partRow(data, 'simulator', campaign.simulator.name)] : loopRows(data, origin)),
    ['Started by', `${launchedBy(run)}, ${moment(run.created)}`],
    ['Finished', run.finished === null ? 'not finished' : moment(run.finished)],
  ]
}

/** From which the independent sample follows, so that a launch can repeat it. */
function sampleSeed({ stages }: RunData): string {
  const certified = resultWith(stages, 'drawn_at_launch')
  if (!certified) return 'no sample'
  if (certified.seed === null) return 'that of the campaign'
  return `${certified.seed}, ${certified.drawn_at_launch ? 'drawn' : 'stated'} at launch`
}

/** One digest of all code, then that of the engine and of each own file. */
function codeRows(identity: Identity | null): Rows {
  const engine: [string, string][] = identity?.engine ? [['Engine', identity.engine]] : []
  const loop: [string, string][] = identity?.loop ? [['Compiled loop', identity.loop]] : []
  const files = Object.entries(identity?.files ?? {})
  return [
    ['Code', <span key="o">{identity?.digest ? <>sha256 {hash(identity.digest)}</> : unreadOf(identity)}</span>],
    ...[...engine, ...loop, ...files].map(([name, digest]): Rows[number] => [name, <span key={name}>{hash(digest)}</span>]),
  ]
}

type PartRole = 'vehicle' | 'controller' | 'avoider' | 'simulator'

/** The title of a part, as the run stored it; its name in files if it is not described. */
export function titleOf(catalogue: RunData['catalogue'], role: PartRole, name: string): string {
  const entries = role === 'simulator' ? catalogue?.simulators : catalogue?.components.filter((each) => each.role === role)
  return entries?.find((each) => each.name === name)?.title || name
}

const partRow = ({ catalogue }: RunData, role: PartRole, name: string): Rows[number] => [
  role.charAt(0).toUpperCase() + role.slice(1),
  <Link key={role} to="/help/components" hash={idOfComponent(role, name)} title={name}>
    {titleOf(catalogue, role, name)}
  </Link>,
]

/** Rows of a closed loop only: integrator, horizon, components. */
function loopRows(data: RunData, origin: Origin): Rows {
  const { campaign } = data
  const period = Number(campaign.scenario.guidance?.period ?? 0)
  return [
    [
      'Integrator',
      `${origin.integrator ?? 'RK4'}, step ${plain((origin.step ?? Number(campaign.scenario.step)) * 1000)} ms`,
    ],
    ['Horizon, guidance', `${campaign.scenario.horizon} s, ${period > 0 ? `every ${plain(period)} s` : 'continuous'}`],
    ...(['vehicle', 'controller', 'avoider'] as const).map((role) => partRow(data, role, campaign.scenario[role].component)),
  ]
}

function machineRows({ run, campaign }: RunData, origin: Origin): Rows {
  const { cpu } = origin
  const packages = Object.entries(origin.packages)
  return [
    ['Clearance', mono(origin.clearance)],
    ['Python', mono(origin.python)],
    ...packages.map(([name, version]): Rows[number] => [name, mono(version)]),
    [
      'Processor',
      <span key="m" title={cpu?.features}>
        {[cpu?.model, cpu?.target].filter(Boolean).join(', ') || 'not recorded'}
      </span>,
    ],
    ...(origin.evaluator
      ? [['Evaluated by', `${origin.evaluator} on other machines, whose processors are not recorded`] as Rows[number]]
      : []),
    ...(campaign.simulator ? [] : [['Lanes', String(origin.lanes ?? 'not recorded')] as Rows[number]]),
    ['Worker, attempts', `${run.worker ?? 'none'}, ${run.attempts}`],
  ]
}
