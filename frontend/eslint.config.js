// Rules for the pages: strict TypeScript with types, and the rules of hooks. Those of React's compiler, which analyse every
// component and take a third of the time, are checked by night.
import js from '@eslint/js'
import hooks from 'eslint-plugin-react-hooks'
import { defineConfig, globalIgnores } from 'eslint/config'
import typescript from 'typescript-eslint'

const nightly = process.env.CLEARANCE_NIGHTLY === '1'
const ofHooks = { 'react-hooks/rules-of-hooks': 'error', 'react-hooks/exhaustive-deps': 'error' }

export default defineConfig([
  globalIgnores(['dist', 'src/client', 'node_modules', 'public', 'eslint.config.js']),
  {
    files: ['**/*.{ts,tsx}'],
    extends: [js.configs.recommended, typescript.configs.recommendedTypeChecked, ...(nightly ? [hooks.configs.flat['recommended-latest']] : [])],
    plugins: nightly ? {} : { 'react-hooks': hooks },
    languageOptions: { parserOptions: { projectService: true, tsconfigRootDir: import.meta.dirname } },
    linterOptions: { reportUnusedDisableDirectives: 'error' },
    rules: {
      ...(nightly ? {} : ofHooks),
      'no-console': 'error',
      eqeqeq: ['error', 'always', { null: 'ignore' }],
      '@typescript-eslint/no-explicit-any': 'error',
      '@typescript-eslint/consistent-type-imports': 'error',
      '@typescript-eslint/switch-exhaustiveness-check': 'error',
    },
  },
])
