// Shown to an unauthenticated browser: how to sign in.
import { clsx } from 'clsx'
import { useEffect } from 'react'
import { BrandMark } from './Brand'
import { at } from '../format/root'
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
        <BrandMark />
        <h1>Sign in with the login link</h1>
        <p>
          Clearance prints a login link when it starts. Open that link in this browser within 15 minutes; it is single-use
          and keeps you signed in.
        </p>
        <p>
          For a new link, run this on the machine where Clearance runs; earlier unused links become invalid:
        </p>
        <pre className="mono">clearance login-link</pre>
        <p>
          With a name and a password, or through your provider: <a href={back}>sign in</a>.
        </p>
        <p className="small mut">Programs use an API token instead, created with clearance token create NAME.</p>
      </div>
    </main>
  )
}
