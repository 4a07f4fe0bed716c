// Shown to an unauthenticated browser: how to sign in.
import { clsx } from 'clsx'
import { useEffect } from 'react'
import { BrandMark } from './Brand'
import { at } from '../format/root'
import buttons from '../ui/buttons.module.css'
import cards from '../ui/cards.module.css'
import styles from './app.module.css'

export function SignedOut() {
  useEffect(() => {
    document.title = 'Sign in · Clearance'
  }, [])
  // A link of the service, not of these pages: it shows the form for a password, and leads back here.
  const back = `${at('/login')}?next=${encodeURIComponent(window.location.pathname + window.location.search)}`
  return (
    <main className={clsx(styles.main, styles.signin)}>
      <div className={cards.card}>
        <span className={styles.brand}>
          <BrandMark />
          <span>Clearance</span>
        </span>
        <h1>You are signed out</h1>
        <p className="sec">Your session has ended. After signing in you return to this page.</p>
        <a className={clsx(buttons.btn, buttons.p)} href={back}>
          Sign in
        </a>
        <p className="small sec">
          Without a password: open the login link that Clearance prints when it starts, in this browser and within 15 minutes; it is
          single-use. For a new link, run this on the machine where Clearance runs; earlier unused links become invalid:
        </p>
        <pre className="mono">clearance login-link</pre>
        <p className="small mut">
          Programs use an API token instead, created with <code>clearance token create NAME</code>.
        </p>
      </div>
    </main>
  )
}
