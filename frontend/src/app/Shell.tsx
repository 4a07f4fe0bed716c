// The frame around every page: header, theme, session; the sign-in page if the service requires it.
import {
  IconApi,
  IconBell,
  IconBellFilled,
  IconKeyboard,
  IconLogout,
  IconMoon,
  IconSearch,
  IconSun,
  IconUserPlus,
} from '@tabler/icons-react'
import { useQuery, useQueryClient } from '@tanstack/react-query'
import { Link, Outlet, useNavigate } from '@tanstack/react-router'
import { clsx } from 'clsx'
import { type ReactNode, useCallback, useEffect, useState } from 'react'
import { pagesFor } from '../access/pages'
import { hasRole } from '../api/access'
import { useBaseStream } from '../api/events'
import { sessionQuery } from '../api/queries'
import { left, signedOut, useSession } from '../api/session'
import { endSession } from '../client'
import { toggleTheme, useTheme } from '../theme/useTheme'
import { keepTyped, typedEarly } from '../jump/early'
import { later, Part } from '../page/later'
import { MenuDivider, MenuItem, MenuLabel } from '../overlay/later'
import { IconButton } from '../ui/IconButton'
import { Modal } from '../overlay/Modal'
import { Popup } from '../overlay/Popup'
import { useHotkeys } from '../ui/useHotkeys'
import { Brand } from './Brand'
import { Contact } from './Contact'
import { Keys } from './Keys'
import { toggleMine, useNotifier, useToggle, useWanted } from '../page/notify'
import { unsaved } from '../page/unsaved'
import { SignedOut } from './SignedOut'
import { Workers } from './Workers'
import { buttons, fields, layout } from '../ui/styles'
import styles from './app.module.css'

const Jump = later(() => import('../jump/Jump'), 'Jump')

const PAGES = ['runs', 'launch', 'compare', 'requirements', 'reports', 'help'] as const

export function Shell() {
  const session = useSession()
  const out = session !== 'open'
  return (
    <>
      {session !== 'left' && (
        <div inert={out} aria-hidden={out}>
          <Frame />
        </div>
      )}
      {out && <SignedOut />}
    </>
  )
}

function Frame() {
  const navigate = useNavigate()
  const [keys, setKeys] = useState(false)
  const [jump, setJump] = useState<'never' | 'open' | 'closed'>('never')
  const search = () => {
    if (jump !== 'open') keepTyped()
    setJump('open')
  }
  useHotkeys({
    '?': () => setKeys(true),
    'Ctrl+k': search,
    n: () => void navigate({ to: '/launch' }),
    '/': () => void navigate({ to: '/runs', search: { focus: 'search' } }),
  })
  const open = useCallback((run: string) => void navigate({ to: '/runs/$id', params: { id: run } }), [navigate])
  useNotifier(open)
  useBaseStream()
  return (
    <>
      <a className={styles.skip} href="#main">
        Skip to content
      </a>
      <header className={clsx(layout.row, styles.top)}>
        <Brand />
        <nav className={clsx(layout.tabs, styles.nav)} aria-label="Main">
          {PAGES.map((name) => (
            <Link key={name} to={`/${name}`} activeProps={{ 'aria-current': 'page' }}>
              {name.charAt(0).toUpperCase() + name.slice(1)}
            </Link>
          ))}
        </nav>
        <div className={clsx(layout.row, layout.atend, styles.topR)}>
          <button type="button" className={clsx(fields.inp, styles.jump)} onClick={search} aria-keyshortcuts="Control+K">
            <IconSearch className="i s mut" aria-hidden />
            <span className={layout.cut}>Search or jump to …</span>
            <span className={buttons.kbd}>Ctrl K</span>
          </button>
          <IconButton bare large className={styles.hideKeys} label="Keys" title="Keys (?)" icon={IconKeyboard} act={() => setKeys(true)} />
          <Workers />
          <ThemeToggle />
          <Session />
        </div>
      </header>
      <Contact />
      <main id="main" className={styles.main} tabIndex={-1}>
        <Outlet />
      </main>
      {jump !== 'never' && (
        <Part failed={(line) => <NoJump onClose={() => setJump('never')}>{line}</NoJump>}>
          <Jump opened={jump === 'open'} onClose={() => setJump('closed')} />
        </Part>
      )}
      <Keys opened={keys} onClose={() => setKeys(false)} />
    </>
  )
}

/** In place of the search. */
function NoJump({ onClose, children }: { onClose: () => void; children: ReactNode }) {
  useEffect(() => void typedEarly(), []) // nothing takes what is typed for it
  return (
    <Modal opened onClose={onClose} title="Search">
      {children}
    </Modal>
  )
}

function ThemeToggle() {
  const theme = useTheme()
  const label = theme === 'dark' ? 'Switch to light theme' : 'Switch to dark theme'
  return <IconButton bare large label={label} icon={theme === 'dark' ? IconSun : IconMoon} act={toggleTheme} />
}

function Session() {
  const { data } = useQuery(sessionQuery)
  const navigate = useNavigate()
  const cache = useQueryClient()
  if (!data) return null
  const initials = data.user.slice(0, 2).toUpperCase()
  const gone = () => {
    if (unsaved()) return signedOut() // what was typed is kept
    left()
    cache.clear()
  }
  const leave = () => void endSession().then(gone, gone)
  return (
    <Popup
      kind="menu"
      width={220}
      button={{ className: clsx('b sec', styles.ava), 'aria-label': `Session of ${data.user}, ${initials}`, children: initials }}
    >
      <MenuLabel>
        Signed in as {data.user} by {{ link: 'login link', password: 'password', provider: 'single sign-on', token: 'token' }[data.via]}, role {data.role}
      </MenuLabel>
      <NotifyMine />
      <MenuItem leftSection={<IconApi className="i s" />} component={Link} to="/docs">
        API
      </MenuItem>
      <MenuDivider />
      {hasRole(data.role, 'admin') && (
        <MenuItem leftSection={<IconUserPlus className="i s" />} onClick={() => void navigate({ to: '/access/users', search: { invite: true } })}>
          Invite
        </MenuItem>
      )}
      {pagesFor(data.role).map(({ to, name, Icon }) => (
        <MenuItem key={to} leftSection={<Icon className="i s" />} component={Link} to={to}>
          {name}
        </MenuItem>
      ))}
      <MenuDivider />
      <MenuItem leftSection={<IconLogout className="i s" />} onClick={leave}>
        Sign out
      </MenuItem>
    </Popup>
  )
}

function NotifyMine() {
  const { mine } = useWanted()
  const [why, press] = useToggle(toggleMine)
  const Icon = mine ? IconBellFilled : IconBell
  return (
    <MenuItem
      leftSection={<Icon className="i s" />}
      closeMenuOnClick={false}
      aria-pressed={mine}
      onClick={press}
    >
      {why || (mine ? 'Notifies when my runs end' : 'Notify when my runs end')}
    </MenuItem>
  )
}
