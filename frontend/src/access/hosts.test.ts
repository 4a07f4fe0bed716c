import { expect, it } from 'vitest'
import { isLocal } from './hosts'

it.each(['localhost', 'clearance.localhost', '127.0.0.1', '127.8.0.1', '[::1]'])('%s is local', (host) => {
  expect(isLocal(host)).toBe(true)
})

it.each(['clearance.example', 'localhost.example', '10.0.0.1', '127.0.0.1.example', '1127.0.0.1', ''])('%s is not', (host) => {
  expect(isLocal(host)).toBe(false)
})
