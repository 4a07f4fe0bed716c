// The parts of Mantine, in code that is loaded when one is first shown; within `Part`.
import { later } from '../page/later'

const parts = () => import('./parts')

export const Overlay = later(parts, 'Overlay')
export const Dialog = later(parts, 'Dialog')
export const TagsInput = later(() => import('./fields'), 'TagsInput')
export const MenuItem = later(parts, 'MenuItem')
export const MenuLabel = later(parts, 'MenuLabel')
export const MenuDivider = later(parts, 'MenuDivider')
