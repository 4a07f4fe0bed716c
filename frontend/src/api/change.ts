// A change of what the service stores. What depends on it is read again, also after a refusal: what is shown may be outdated.
import { useMutation, useQueryClient } from '@tanstack/react-query'

/** `keys`: the first parts of the keys of the queries that are read again; `onDone` is called after that, unless it was refused. */
export function useChange<T, V = void>(call: (of: V) => Promise<T>, keys: readonly string[], onDone?: () => void) {
  const cache = useQueryClient()
  const readAgain = () => Promise.all(keys.map((key) => cache.invalidateQueries({ queryKey: [key] })))
  return useMutation({ mutationFn: call, onSuccess: () => readAgain().then(onDone), onError: () => void readAgain() })
}
