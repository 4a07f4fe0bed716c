// The name and tags of the run: those of the campaign until the user gives others. Another campaign brings its own.
import { useState } from 'react'
import type { Campaign } from '../../api/campaign'
import { stretch } from './history'

export interface Names {
  name: string
  tags: string[]
}

interface Own extends Names {
  /** The campaign that was seen last. */
  of: Campaign
  /** The text was replaced by another campaign, which is not parsed yet. */
  replaced: boolean
}

const nameOf = ({ name }: Campaign): string => String(name ?? '')
const tagsOf = ({ tags }: Campaign): string[] => (tags ?? []).map(String)
const same = (one: readonly string[], other: readonly string[]) => one.join('\n') === other.join('\n')

/** Name and tags after the campaign has changed. */
export function followed({ name, tags, of, replaced }: Own, campaign: Campaign): Own {
  return {
    name: replaced || name === nameOf(of) ? nameOf(campaign) : name,
    tags: replaced || same(tags, tagsOf(of)) ? tagsOf(campaign) : tags,
    of: campaign,
    replaced: false,
  }
}

/** Whether an edit of the text replaces the campaign: a pasted file, which may share some first and last letters. */
export function isAnother(before: string, after: string): boolean {
  const edit = stretch(before, after)
  const most = before.trim() === '' || edit.before.length > before.length / 2
  return most && edit.after.length > after.length / 2 && edit.after.includes('\n')
}

export function useNames(first: Names, campaign: Campaign) {
  const [own, setOwn] = useState<Own>({ ...first, of: campaign, replaced: false })
  // Adjusted during rendering, so that the old name is not shown in between.
  if (own.of !== campaign) setOwn(followed(own, campaign))
  return {
    name: own.name,
    tags: own.tags,
    setName: (name: string) => setOwn((before) => ({ ...before, name, replaced: false })),
    setTags: (tags: string[]) => setOwn((before) => ({ ...before, tags, replaced: false })),
    /** Another campaign was opened, dropped or pasted. */
    replace: () => setOwn((before) => ({ ...before, replaced: true })),
  }
}
