// Whether this browser is signed in; any 401 means that it is not.
import { storeOf } from '../ui/store'

const out = storeOf(false)

export const signedOut = (): void => out.set(true)

export const useSignedOut = out.useValue
