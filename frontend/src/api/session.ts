// Whether this browser is signed in; any 401 means that it is not, until its session is asked for and there is one.
import { storeOf } from '../ui/store'

const out = storeOf(false)

export const signedOut = (): void => out.set(true)
export const signedIn = (): void => out.set(false)

export const useSignedOut = out.useValue
