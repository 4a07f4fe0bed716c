// The pages about access, and the least role that each is for.
import { IconDeviceLaptop, IconHistory, IconKey, IconUsers } from '@tabler/icons-react'
import { hasRole, type Role } from '../api/access'

const PAGES = [
  { to: '/access/users', name: 'Users', Icon: IconUsers, least: 'admin' },
  { to: '/access/tokens', name: 'API tokens', Icon: IconKey, least: 'viewer' },
  { to: '/access/sessions', name: 'Sessions', Icon: IconDeviceLaptop, least: 'viewer' },
  { to: '/access/audit', name: 'Audit trail', Icon: IconHistory, least: 'reviewer' },
] as const

export const pagesFor = (role: Role | undefined) => PAGES.filter(({ least }) => hasRole(role, least))
