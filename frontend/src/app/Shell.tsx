// The frame around every page: header, theme, session; the sign-in page where the service asks for one.
import { Menu } from '@mantine/core'
import { IconApi, IconLogout, IconMoon, IconSun } from '@tabler/icons-react'
import { useQuery } from '@tanstack/react-query'
import { Link, Outlet } from '@tanstack/react-router'
import { endSession } from '../api/calls'
import { sessionQuery } from '../api/queries'
import { signedOut, useSignedOut } from '../api/session'
import { toggleTheme, useTheme } from '../theme/useTheme'
import { Brand } from './Brand'
import { SignedOut } from './SignedOut'

export function Shell() {
  const out = useSignedOut()
  if (out) return <SignedOut />
  return (
    <>
      <a className="skip" href="#main">
        Skip to content
      </a>
      <header className="top">
        <Brand />
        <nav className="nav" aria-label="Main">
          <Link to="/runs" activeProps={{ 'aria-current': 'page' }}>
            Runs
          </Link>
          <Link to="/launch" activeProps={{ 'aria-current': 'page' }}>
            Launch
          </Link>
        </nav>
        <div className="top-r">
          <ThemeToggle />
          <Session />
        </div>
      </header>
      <main id="main" tabIndex={-1}>
        <Outlet />
      </main>
    </>
  )
}

function ThemeToggle() {
  const theme = useTheme()
  const label = theme === 'dark' ? 'Switch to light theme' : 'Switch to dark theme'
  return (
    <button type="button" className="iconbtn" onClick={toggleTheme} aria-label={label} title={label}>
      {theme === 'dark' ? <IconSun className="i" aria-hidden /> : <IconMoon className="i" aria-hidden />}
    </button>
  )
}

function Session() {
  const { data } = useQuery(sessionQuery)
  if (!data) return null
  const leave = () => void endSession().then(signedOut, signedOut)
  return (
    <Menu position="bottom-end" width={220}>
      <Menu.Target>
        <button type="button" className="ava" aria-label={`Session of ${data.user}`}>
          {data.user.slice(0, 2).toUpperCase()}
        </button>
      </Menu.Target>
      <Menu.Dropdown>
        <Menu.Label>
          Signed in as {data.user} by {data.via === 'link' ? 'login link' : 'token'}
        </Menu.Label>
        <Menu.Item leftSection={<IconApi className="i s" />} component="a" href="/api/v1/openapi.json" target="_blank">
          OpenAPI document
        </Menu.Item>
        <Menu.Divider />
        <Menu.Item leftSection={<IconLogout className="i s" />} onClick={leave}>
          Sign out
        </Menu.Item>
      </Menu.Dropdown>
    </Menu>
  )
}
