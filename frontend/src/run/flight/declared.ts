// What the traces of a simulator declare of its 3D view.
import { hasScenario } from '../../api/campaign'
import type { Scene } from '../../client'
import type { RunData } from '../data/data'
import { CAMERAS, type Camera } from '../data/viewChange'

type Traced = Pick<RunData, 'campaign' | 'traces'>

/** What is drawn of a simulator; null if none of its stored traces declares it. */
export const sceneOf = ({ traces }: Pick<RunData, 'traces'>): Scene | null =>
  traces.find(({ meta }) => meta.scene)?.meta.scene ?? null

/** Whether the page has a 3D view. */
export const hasView = (data: Traced & Pick<RunData, 'nominalTrace'>): boolean =>
  hasScenario(data.campaign) ? data.nominalTrace !== undefined : sceneOf(data) !== null

/** The cameras of a view; the closest approach of a simulator is not known. */
export const camerasOf = (data: Pick<RunData, 'campaign'>): readonly Camera[] =>
  hasScenario(data.campaign) ? CAMERAS : CAMERAS.filter((camera) => camera !== 'encounter' && camera !== 'intruder')
