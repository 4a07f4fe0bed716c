// A value outside of React, whose changes the components that read it show.
import { useSyncExternalStore } from 'react'

export class Store<T> {
  private readonly listeners = new Set<() => void>()

  constructor(private value: T) {}

  readonly get = (): T => this.value

  set(value: T): void {
    this.value = value
    for (const listener of this.listeners) listener()
  }

  readonly useValue = (): T => useSyncExternalStore(this.subscribe, this.get)

  private readonly subscribe = (listener: () => void): (() => void) => {
    this.listeners.add(listener)
    return () => this.listeners.delete(listener)
  }
}
