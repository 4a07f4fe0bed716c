// What each part of the form gets: the campaign, what the catalogue says of it, and how it is changed.
import type { Campaign, List } from '../../api/campaign'
import type { Catalogue } from '../../client'
import type { Parameter } from '../campaign/parameters'

export type SetValue = (at: readonly (string | number)[], value: unknown) => void

export interface FormProps {
  campaign: Campaign
  catalogue: Catalogue
  parameters: Parameter[]
  set: SetValue
  /** Removes a part of a list, with all references to it. */
  remove: (list: List | 'objectives', index: number) => void
}
