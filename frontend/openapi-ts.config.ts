// Generates the typed client of the service from its committed OpenAPI document into src/client (never edited by hand).
import { defineConfig } from '@hey-api/openapi-ts'

export default defineConfig({
  input: './openapi.json',
  output: { path: './src/client', clean: true },
  // A request resolves with the data of its answer, and rejects with why it was refused (src/api/calls.ts).
  plugins: ['@hey-api/typescript', { name: '@hey-api/sdk', responseStyle: 'data' }, { name: '@hey-api/client-fetch', throwOnError: true }],
})
