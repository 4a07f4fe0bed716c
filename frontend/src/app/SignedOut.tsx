// Above the page of a browser whose session has ended: how to sign in. The page stays below with what was typed, and goes on
// once its user has signed in again, in this tab or in another.
import { useQueryClient } from '@tanstack/react-query'
import { clsx } from 'clsx'
import { useEffect, useLayoutEffect, useRef, useState } from 'react'
import { sessionQuery } from '../api/queries'
import { signedIn } from '../api/session'
import { getSession, type SessionInfo } from '../client'
import { BrandMark } from './Brand'
import { at } from '../format/root'
import { unsaved } from '../page/unsaved'
import { ButtonAnchor } from '../ui/Button'
import { inTurn } from '../ui/usePolling'
import { cards, layout } from '../ui/styles'
import styles from './app.module.css'

export function SignedOut() {
  const notice = useRef<HTMLDialogElement>(null)
  const [kept] = useState(unsaved)
  useReturn()
  useLayoutEffect(() => {
    // Above dialogs of the page, too, and nothing else has the keys.
    if (notice.current?.open === false) notice.current.showModal()
  }, [])
  useEffect(() => {
    const before = document.title
    document.title = 'Sign in · Clearance'
    return () => void (document.title = before)
  }, [])
  // A link of the service, not of these pages: it shows the form for a password, and leads back here.
  const back = `${at('/login')}?next=${encodeURIComponent(window.location.pathname + window.location.search)}`
  return (
    <dialog
      ref={notice}
      className={styles.signin}
      aria-labelledby="signed-out"
      onCancel={(event) => event.preventDefault()}
      onClose={(event) => event.currentTarget.showModal()} // Escape, pressed twice, closes it nevertheless
    >
      <div className={cards.card}>
        <span className={clsx(layout.row, 'b', styles.brand)}>
          <BrandMark />
          <span>Clearance</span>
        </span>
        <h1 id="signed-out">You are signed out</h1>
        <p className="sec">
          {kept
            ? 'Your session has ended. What you typed on this page is kept. Sign in on a new tab, then come back to this one.'
            : 'Your session has ended. After signing in you return to this page.'}
        </p>
        <ButtonAnchor main href={back} target={kept ? '_blank' : undefined}>
          {kept ? 'Sign in on a new tab' : 'Sign in'}
        </ButtonAnchor>
        <p className="small sec">
          Without a password: open the login link that Clearance prints when it starts, in this browser and within 15 minutes; it is
          single-use. For a new link, run this on the machine where Clearance runs; earlier unused links become invalid:
        </p>
        <pre className="mono">clearance login-link</pre>
        <p className="small mut">
          Programs use an API token instead, created with <code>clearance token create NAME</code>.
        </p>
      </div>
    </dialog>
  )
}

/** Asks for the session whenever the user comes back to this tab; with one, the page goes on. */
function useReturn(): void {
  const cache = useQueryClient()
  useEffect(() => {
    const turn = inTurn()
    const ask = async () => {
      try {
        const before = cache.getQueryData<SessionInfo>(sessionQuery.queryKey)
        const session = await getSession()
        // What is below belongs to who has read and typed it.
        if (before && before.account !== session.account) return location.reload()
        cache.setQueryData(sessionQuery.queryKey, session)
        signedIn()
        void cache.invalidateQueries({ predicate: ({ state }) => state.status === 'error' })
      } catch {
        // Not yet.
      }
    }
    const come = () => document.hidden || turn(ask)
    window.addEventListener('focus', come)
    document.addEventListener('visibilitychange', come)
    return () => {
      window.removeEventListener('focus', come)
      document.removeEventListener('visibilitychange', come)
    }
  }, [cache])
}
