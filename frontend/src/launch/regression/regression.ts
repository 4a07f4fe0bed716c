// Labels and baseline of a launch as typed; the same syntax as on the command line, so that a line of a CI job fits.
import { useState } from 'react'

/** As the service allows. */
const MOST = 20
const KEY = /^[A-Za-z][\w.-]{0,39}$/
const RUN = /^R-\d+$/

/** Labels by key, or why the texts cannot be used. */
export function labelsOf(texts: readonly string[]): { labels: Record<string, string> } | { problem: string } {
  const labels: Record<string, string> = {}
  for (const text of texts) {
    const [, key, value] = /^([^=]*)=([^]*)$/.exec(text)?.map((part) => part.trim()) ?? []
    if (!key || !value) return { problem: `“${text}” is not a label: give KEY=VALUE, such as branch=main.` }
    if (!KEY.test(key)) return { problem: `“${key}” cannot be a key: a letter, then letters, digits, “_”, “.” and “-”, at most 40.` }
    if (Object.hasOwn(labels, key) && labels[key] !== value) return { problem: `${key} is given twice: a label has one value.` }
    labels[key] = value
  }
  if (texts.length > MOST) return { problem: `${texts.length} labels, at most ${MOST} are allowed.` }
  return { labels }
}

/** Why a text names no baseline; empty if it does, or if there is none. */
export function baselineProblem(text: string): string {
  const reference = text.trim()
  if (reference === '' || RUN.test(reference)) return ''
  if (!reference.startsWith('label:')) return `“${reference}” is not a baseline: give a run such as R-0001, or label:branch=main.`
  const found = labelsOf([reference.slice('label:'.length)])
  return 'problem' in found ? found.problem : ''
}

export interface Regression {
  labels: string[]
  baseline: string
  setLabels: (labels: string[]) => void
  setBaseline: (baseline: string) => void
  /** Why they cannot be used, as a sentence; empty if they can. */
  problem: { labels: string; baseline: string }
  /** As the request has them. */
  request: { labels: Record<string, string>; baseline: string | null }
}

/** As texts, for the fields. */
export const textsOf = (labels: Readonly<Record<string, string>>): string[] =>
  Object.entries(labels).map(([key, value]) => `${key}=${value}`)

export function useRegression(start: { labels?: readonly string[]; baseline?: string }): Regression {
  const [labels, setLabels] = useState<string[]>([...(start.labels ?? [])])
  const [baseline, setBaseline] = useState(start.baseline ?? '')
  const found = labelsOf(labels)
  return {
    labels,
    baseline,
    setLabels,
    setBaseline,
    problem: { labels: 'problem' in found ? found.problem : '', baseline: baselineProblem(baseline) },
    request: { labels: 'labels' in found ? found.labels : {}, baseline: baseline.trim() || null },
  }
}
