// The switch between the encounter and the whole flight, the same on every chart over time or position.
import { Seg, type SegProps } from './Card'

export type Shown = 'encounter' | 'all'

export const WindowSeg = (props: Omit<SegProps<Shown>, 'options'>) => <Seg options={{ encounter: 'Encounter', all: 'Whole flight' }} {...props} />
