// What each part of the form gets: the campaign, what the catalogue says of it, and how it is changed.
import type { Catalogue } from '../../client'
import type { Parameter } from '../campaign/parameters'
import type { Draft } from '../draft/useDraft'

export type SetValue = Draft['set']

export interface FormProps extends Pick<Draft, 'campaign' | 'set' | 'remove'> {
  catalogue: Catalogue
  parameters: Parameter[]
}
