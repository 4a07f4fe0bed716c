// Builds the pages into `dist`, which the service serves; in development the service's own port answers the API.
import { readFileSync, writeFileSync } from 'node:fs'
import { join } from 'node:path'
import { brotliCompressSync } from 'node:zlib'
import react from '@vitejs/plugin-react'
import type { Plugin } from 'vite'
import { defineConfig } from 'vitest/config'

const service = process.env.CLEARANCE_URL ?? 'http://127.0.0.1:8000'

/** What pages share comes to all of them, but not what starts them, nor what only a campaign's text needs. */
const SHARED = /^(?!.*(src.api.ahead|src.format.root|preload-helper|src.launch.text|src.help.texts|docs.[\w-]+\.md|node_modules.(yaml|@codemirror|@lezer)))/

/** What both the start and the pages need, in one file: each costs the browser and the service some milliseconds. */
const START = /src.format.root|preload-helper/

/** What opens over a page, loaded when something first does. */
const MANTINE = /node_modules.(@mantine.core.esm|@floating-ui|react-remove-scroll|react-style-singleton|react-number-format)|src.overlay.(parts|fields|Themed|theme)/

/** Names in the page itself the code of every page: a browser asks for it without reading any other code first. */
const atOnce: Plugin = {
  name: 'at-once',
  transformIndexHtml: {
    order: 'post',
    handler: (_, { bundle = {} }) =>
      Object.values(bundle)
        .filter((file) => file.type === 'chunk' && ['Pages', 'shared', 'rolldown-runtime'].includes(file.name))
        .map((file) => ({
          tag: 'link',
          attrs: { rel: 'preload', as: 'script', crossorigin: true, href: `./${file.fileName}` },
          injectTo: 'head',
        })),
  },
}

/** Packs code and styles once and as small as can be, as `FILE.br` beside them: the service sends those. */
const packed: Plugin = {
  name: 'packed',
  writeBundle({ dir = '' }, bundle) {
    for (const { fileName } of Object.values(bundle).filter((file) => /^assets\/.*\.(js|css)$/.test(file.fileName)))
      writeFileSync(join(dir, `${fileName}.br`), brotliCompressSync(readFileSync(join(dir, fileName))))
  },
}

export default defineConfig({
  // Relative: the service may be found below a path, which it writes into the page (backend/http/pages.py).
  base: './',
  plugins: [react(), atOnce, packed],
  css: { modules: { localsConvention: 'camelCaseOnly', generateScopedName: '[hash:base64:5]' } },
  build: {
    // The content security policy allows no data: fonts or scripts, so nothing is inlined.
    assetsInlineLimit: 0,
    chunkSizeWarningLimit: 700,
    modulePreload: { polyfill: false },
    // One style sheet, named in the page itself: no code waits for another.
    cssCodeSplit: false,
    rolldownOptions: {
      output: {
        // Few files: a browser fetches six at a time. What several pages share comes in one, charts in another; charts
        // need what is shared, so that nothing shared may need charts: ticks are numbers alone.
        codeSplitting: {
          includeDependenciesRecursively: false,
          groups: [
            { name: 'start', test: START, priority: 2 },
            { name: 'mantine', test: MANTINE, priority: 1 },
            { name: 'charts', test: /node_modules.uplot|src.charts.(?!ticks)/, priority: 1 },
            { name: 'shared', test: SHARED, minShareCount: 2 },
          ],
        },
      },
    },
  },
  server: {
    proxy: Object.fromEntries(
      ['/api', '/login', '/view'].map((path) => [path, { target: service, ws: true }]),
    ),
  },
  test: {
    environment: 'node',
    include: ['src/**/*.test.{ts,tsx}'],
    setupFiles: ['tests/browser.ts'],
    // Modules are loaded once for all files, in half the processor time: a test that stubs a global puts it back.
    pool: 'threads',
    isolate: false,
    // Only to end what hangs: the machine may be busy.
    testTimeout: 600_000, // `make test` runs them at the lowest priority, beside everything else
    hookTimeout: 600_000,
  },
})
