// Whether this browser is signed in; any 401 means that it is not.
import { Store } from '../ui/store'

const out = new Store(false)

export const signedOut = (): void => out.set(true)

export const useSignedOut = out.useValue
