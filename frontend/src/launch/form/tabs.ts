// The sections of the form of a campaign, for the tabs above it.
import { type Campaign, hasScenario } from '../../api/campaign'
import type { Section } from '../../ui/SectionTabs'
import { idOf } from '../fields/problems'

/** In their order on the page. */
export const tabsOf = (campaign: Campaign): Section[] => [
  { id: 'section-uncertain', name: 'Parameters', count: Object.keys(campaign.uncertain).length },
  { id: 'section-criterion', name: 'Criterion' },
  ...(hasScenario(campaign) ? [] : [{ id: 'section-proposal', name: 'Proposal' }]),
  { id: 'section-methods', name: 'Methods', count: campaign.stages.search.length },
  { id: 'section-stages', name: 'Certify, verdict' },
  hasScenario(campaign) ? { id: idOf('scenario'), name: 'Scenario' } : { id: idOf('simulator'), name: 'Simulator' },
  { id: 'section-about', name: 'About' },
]
