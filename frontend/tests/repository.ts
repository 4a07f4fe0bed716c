// For tests: the repository's Python code reads, checks and writes the campaigns with which the pages are compared.
import { execFileSync } from 'node:child_process'
import { fileURLToPath } from 'node:url'
import type { Campaign } from '../src/api/campaign'
import type { Catalogue } from '../src/client'

const ROOT = fileURLToPath(new URL('../..', import.meta.url))

function output(program: string, input = ''): string {
  const options = { cwd: ROOT, input, encoding: 'utf-8', maxBuffer: 1e8, stdio: 'pipe' } as const
  return execFileSync(`${ROOT}/.venv/bin/python`, ['-c', program], options)
}

/** Runs a program and parses its JSON output. */
export const python = <T>(program: string, input = ''): T => JSON.parse(output(program, input)) as T

const READ = `
import json
from campaigns import Campaign, library, load_file
from worker.running.catalogue.installed import catalogue
def shipped(path):
    campaign = load_file(path)
    return {"document": campaign.document(), "digest": campaign.digest, "text": path.read_text(encoding="utf-8")}
found = {name: shipped(path) for name, path in library().items()}
print(json.dumps({"catalogue": catalogue().model_dump(mode="json"), "campaigns": found, "schema": Campaign.model_json_schema()}))
`

export type ShippedCampaigns = Record<string, { document: Campaign; digest: string; text: string }>

type Shipped = { catalogue: Catalogue; campaigns: ShippedCampaigns; schema: unknown }
let read: string | null = null

/** The catalogue of the installed components, and the library's campaigns: read once, a copy for each file of tests. */
export function shipped(): Shipped {
  read ??= output(READ)
  return JSON.parse(read) as Shipped
}
