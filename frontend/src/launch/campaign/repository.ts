// For tests: the repository's Python code reads, checks and writes the campaigns with which the pages are compared.
import { execFileSync } from 'node:child_process'
import { fileURLToPath } from 'node:url'
import type { Campaign } from '../../api/campaign'
import type { Catalogue } from '../../client'

const ROOT = fileURLToPath(new URL('../../../..', import.meta.url))

/** Runs a program and parses its JSON output. */
export function python<T>(program: string, input = ''): T {
  const options = { cwd: ROOT, input, encoding: 'utf-8', maxBuffer: 1e8, stdio: 'pipe' } as const
  return JSON.parse(execFileSync(`${ROOT}/.venv/bin/python`, ['-c', program], options)) as T
}

const READ = `
import json
from campaigns import Campaign, library, load_file
from worker.catalogue.installed import catalogue
def told(path):
    campaign = load_file(path)
    return {"document": campaign.document(), "digest": campaign.digest, "text": path.read_text(encoding="utf-8")}
found = {name: told(path) for name, path in library().items()}
print(json.dumps({"catalogue": catalogue().model_dump(mode="json"), "campaigns": found, "schema": Campaign.model_json_schema()}))
`

export type Told = Record<string, { document: Campaign; digest: string; text: string }>

/** The catalogue of the installed components, and the library's campaigns. */
export const shipped = (): { catalogue: Catalogue; campaigns: Told; schema: unknown } => python(READ)
