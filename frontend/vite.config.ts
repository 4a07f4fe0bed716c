// Builds the pages into `dist`, which the service serves; in development the service's own port answers the API.
import react from '@vitejs/plugin-react'
import { defineConfig } from 'vitest/config'

const service = process.env.CLEARANCE_URL ?? 'http://127.0.0.1:8000'

export default defineConfig({
  plugins: [react()],
  build: {
    // The content security policy allows no data: fonts or scripts, so nothing is inlined.
    assetsInlineLimit: 0,
    chunkSizeWarningLimit: 700,
    modulePreload: { polyfill: false },
  },
  server: {
    proxy: Object.fromEntries(
      ['/api', '/login', '/view'].map((path) => [path, { target: service, ws: true }]),
    ),
  },
  test: { environment: 'node', include: ['src/**/*.test.{ts,tsx}'] },
})
