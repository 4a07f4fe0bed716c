// Keys, and what a page from another machine lacks without TLS.
import { readdirSync, readFileSync } from 'node:fs'
import { join } from 'node:path'
import { fileURLToPath } from 'node:url'
import { expect, it } from 'vitest'
import { uuid } from './keys'

const SRC = fileURLToPath(new URL('..', import.meta.url))

/** "Features restricted to secure contexts", developer.mozilla.org: undefined on a page by plain HTTP. */
const WITHHELD =
  /\b(randomUUID|crypto\.subtle|navigator\.(clipboard|locks|serviceWorker|share|storage|mediaDevices|wakeLock|credentials|gpu)|caches|cookieStore|show(Open|Save)FilePicker|SharedArrayBuffer)\b/

it('makes keys of version 4, each another one', () => {
  const keys = Array.from({ length: 50 }, uuid)
  for (const key of keys) expect(key).toMatch(/^[0-9a-f]{8}-[0-9a-f]{4}-4[0-9a-f]{3}-[89ab][0-9a-f]{3}-[0-9a-f]{12}$/)
  expect(new Set(keys).size).toBe(50)
})

it('uses what is withheld on plain HTTP only where there is a substitute', () => {
  const files = readdirSync(SRC, { recursive: true, encoding: 'utf-8' })
  const code = files.filter((file) => /\.tsx?$/.test(file) && !/^client\b|\.test\.tsx?$/.test(file))
  expect(code.length).toBeGreaterThan(300)
  const lines = (file: string) => readFileSync(join(SRC, file), 'utf-8').split('\n').filter((line) => !/^\s*(\/\/|\/?\*)/.test(line))
  const using = code.filter((file) => lines(file).some((line) => WITHHELD.test(line)))
  expect(using).toEqual(['ui/files.tsx'])
})
