// The rules of React's compiler, which analyse every component and take a third of a minute: by night. All others: .oxlintrc.json.
import hooks from 'eslint-plugin-react-hooks'
import { defineConfig, globalIgnores } from 'eslint/config'
import typescript from 'typescript-eslint'

export default defineConfig([
  globalIgnores(['dist', 'src/client', 'node_modules', 'public', 'eslint.config.js']),
  {
    files: ['**/*.{ts,tsx}'],
    extends: [hooks.configs.flat['recommended-latest']],
    languageOptions: { parser: typescript.parser },
    rules: { 'react-hooks/rules-of-hooks': 'off', 'react-hooks/exhaustive-deps': 'off' },
  },
])
