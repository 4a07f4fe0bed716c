// Whether this browser is signed in; any 401 means that it is not, until its session is asked for and there is one.
import { storeOf } from '../ui/store'

/** `ended`: by itself, so that the page is kept; `left`: by its user, of whom nothing stays. */
type Session = 'open' | 'ended' | 'left'

const session = storeOf<Session>('open')

export const signedOut = (): void => session.set(session.get() === 'left' ? 'left' : 'ended')
export const left = (): void => session.set('left')
export const signedIn = (): void => session.set('open')

export const useSession = session.useValue
