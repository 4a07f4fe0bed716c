import { expect, it } from 'vitest'
import { browserOf } from './browser'

const CHROME = 'Mozilla/5.0 (X11; Linux x86_64) AppleWebKit/537.36 (KHTML, like Gecko) Chrome/131.0.0.0 Safari/537.36'

it.each([
  [CHROME, 'Chrome on Linux'],
  [`${CHROME} Edg/131.0`, 'Edge on Linux'],
  ['Mozilla/5.0 (Macintosh; Intel Mac OS X 10.15; rv:133.0) Gecko/20100101 Firefox/133.0', 'Firefox on macOS'],
  ['Mozilla/5.0 (iPhone; CPU iPhone OS 18_0 like Mac OS X) AppleWebKit/605.1.15 Version/18.0 Mobile Safari/604.1', 'Safari on iOS'],
  ['Mozilla/5.0 (Linux; Android 15) AppleWebKit/537.36 Chrome/131.0 Mobile Safari/537.36', 'Chrome on Android'],
  ['python-httpx/0.28', 'python-httpx/0.28'],
  ['', 'not recorded'],
  ['x'.repeat(200), `${'x'.repeat(39)}…`],
])('names %s', (agent, name) => {
  expect(browserOf(agent)).toBe(name)
})
